"""What is taken away says the same as the curriculum, to the parsers of those who take it."""

from __future__ import annotations

import ast
import csv
import io
import json
import os
import re
import shlex
import subprocess
import sys
from dataclasses import replace
from itertools import chain, combinations
from pathlib import Path
from types import SimpleNamespace

import gymnasium
import numpy as np
import pytest

from surmount.cli.main import run
from surmount.core.errors import ConfigError, InputError
from surmount.exports.formats import export_curriculum
from surmount.exports.ml_agents import export_ml_agents, interval_counts
from surmount.tasks.curriculum import Box, Curriculum, Group, Level
from surmount.teachers.advancement import AdvancementConfig
from surmount.teachers.levels import LevelTeacher
from surmount.teachers.teacher import Episodes, RolloutOutcome
from surmount.trials.table import read_trials


def group(name, variants, rate, *boxes):
    return Group(
        name=name,
        variants=np.array(variants, dtype=float),
        success_rate=rate,
        boxes=tuple(
            Box(lower=np.array(low), upper=np.array(high), weight=float(weight))
            for low, high, weight in boxes
        ),
    )


STEP = Curriculum(
    parameters=("height_mm",),
    groups=(
        group("easy", [[21.0], [22.0]], 0.96, ([21.0], [33.5], 13)),
        group("medium", [[34.0], [48.0]], 0.2, ([33.5], [46.5], 13), ([48.0], [48.0], 1)),
        group("difficult", [[47.0], [50.0]], 0.0, ([46.5], [50.0], 4)),
    ),
    levels=(
        Level(dominant="medium", weights=(0.25, 0.7, 0.05)),
        Level(dominant="difficult", weights=(0.2, 0.1, 0.7)),
    ),
    success_threshold=0.95,
)
TWO = Curriculum(
    parameters=("gravity", "wind"),
    groups=(
        group("easy", [[1.0, 0.0]], 0.9, ([0.5, 0.0], [1.5, 5.0], 1)),
        group("difficult", [[2.0, 9.0]], 0.1, ([1.5, 5.0], [2.5, 9.0], 1)),
    ),
    levels=(Level(dominant="difficult", weights=(0.3, 0.7)),),
    success_threshold=0.95,
)
PARSE = """
import json, sys, yaml
from mlagents.trainers.settings import RunOptions
for path in sys.argv[1:]:
    options = RunOptions.from_dict(yaml.safe_load(open(path)))
    for name, settings in options.environment_parameters.items():
        print(json.dumps([name, [
            [lesson.name, lesson.value.intervals if hasattr(lesson.value, "intervals") else None,
             lesson.completion_criteria and lesson.completion_criteria.threshold]
            for lesson in settings.curriculum]]))
"""


def intervals_of(text: str) -> list[np.ndarray]:
    return [np.array(json.loads(found)) for found in re.findall(r"intervals: (.*)", text)]


def drawn_share(intervals, low, high) -> float:
    """Probability that ML-Agents draws within bounds: intervals by length, uniform within."""
    length = np.ptp(intervals, axis=1)
    inside = np.clip(np.minimum(intervals[:, 1], high) - np.maximum(intervals[:, 0], low), 0, None)
    return float(inside.sum() / length.sum())


def test_ml_agents_draws_groups_by_their_weights():
    export = export_ml_agents(STEP)
    for number, level in enumerate(STEP.levels):
        for text in (
            intervals_of(export.files["curriculum.yaml"])[number],
            intervals_of(export.files[f"level_{number + 1}.yaml"])[0],
        ):
            # 1 mm around the single variant of 48 mm lies within the interval of the hardest.
            easy = drawn_share(text, 21.0, 33.5)
            assert easy == pytest.approx(level.weights[0], abs=0.006)
            medium = drawn_share(text, 33.5, 46.5)
            assert medium == pytest.approx(level.weights[1] * 13 / 14, abs=0.006)
    assert any("48 became an interval of" in note for note in export.notes)
    assert any("cannot express the test of eq. 5" in note for note in export.notes)
    assert sum("weights are met to within" in note for note in export.notes) == 2


def test_the_printed_error_is_the_realised_one():
    weights, lengths = np.array([0.7, 0.2, 0.1]), np.array([3.0, 12.5, 13.0])
    counts, error = interval_counts(weights, lengths)
    realised = counts * lengths / (counts @ lengths)
    assert error == pytest.approx(np.abs(realised - weights).max())
    assert error <= 0.005
    assert (counts >= 1).all()


def test_the_printed_error_holds_for_any_intervals_taken_together():
    weights = np.array([0.2, 0.2, 0.2, 0.2, 0.2])
    lengths = np.array([100.0, 99.0, 0.3, 0.7, 3.0])
    counts, error = interval_counts(weights, lengths)
    difference = counts * lengths / (counts @ lengths) - weights
    assert (difference > 0.01).sum() > 1 < (difference < -0.01).sum()
    some = chain.from_iterable(combinations(difference, size) for size in range(1, 5))
    assert error == pytest.approx(max(abs(sum(one)) for one in some))


def test_a_narrow_group_beside_a_wide_one_is_told_and_fills_no_file():
    uneven = Curriculum(
        parameters=("height_mm",),
        groups=(
            group("easy", [[0.0], [999.0]], 0.96, ([0.0], [1000.0], 2)),
            group("difficult", [[1000.0], [1000.001]], 0.1, ([1000.0], [1000.001], 2)),
        ),
        levels=(Level(dominant="difficult", weights=(0.3, 0.7)),),
        success_threshold=0.95,
    )
    export = export_ml_agents(uneven)
    (found,) = intervals_of(export.files["curriculum.yaml"])
    assert len(found) <= 400
    said = re.search(r"weights are met to within ([\d.]+) percentage points", export.notes[0])
    assert float(said[1]) == pytest.approx(
        100 * (drawn_share(found, 0.0, 1000.0) - 0.3), rel=0.05  # two digits are printed
    )  # fmt: skip
    assert "`--to csv`" in export.notes[1]


def test_many_boxes_keep_the_weights_of_their_groups():
    rng = np.random.default_rng(0)
    weights = rng.choice([0.25, 0.7, 0.05], size=600)
    weights /= weights.sum()
    counts, _ = interval_counts(weights, np.ones(600))
    for weight in np.unique(weights):
        group = weights == weight
        assert counts[group].sum() / counts.sum() == pytest.approx(weights[group].sum(), abs=0.006)
    assert counts.sum() <= 6000


def parameter_of(text: str) -> object:
    """Return the one name under ``environment_parameters``, as YAML says it."""
    try:
        import yaml  # noqa: PLC0415 - not a dependency
    except ModuleNotFoundError:
        return json.loads(text.splitlines()[1].strip().removesuffix(":"))
    (name,) = yaml.safe_load(text)["environment_parameters"]
    return name


@pytest.mark.parametrize(
    "name", ["height: mm # x", "on", "~", "1e3", "- h", "{h}", 'a "b" \\c', "&h", "h:", "?"]
)
def test_no_name_of_a_parameter_is_taken_for_something_else(name):
    named = replace(STEP, parameters=(name,))
    export = export_ml_agents(named)
    for file in ("curriculum.yaml", "level_1.yaml", "level_2.yaml"):
        assert parameter_of(export.files[file]) == name


def test_behaviours_and_groups_are_read_as_they_are_written():
    yaml = pytest.importorskip("yaml", reason="needs PyYAML")
    names = {"medium": "no \U0001f916: #1"}
    groups = tuple(replace(one, name=names.get(one.name, one.name)) for one in STEP.groups)
    levels = (Level(dominant=names["medium"], weights=STEP.levels[0].weights), STEP.levels[1])
    odd = replace(STEP, groups=groups, levels=levels)
    text = export_ml_agents(odd, behavior="Größe: \U0001f916\x7f").files["curriculum.yaml"]
    assert text.isascii()
    first = yaml.safe_load(text)["environment_parameters"]["height_mm"]["curriculum"][0]
    assert first["name"] == "level_1_no_\U0001f916:_#1"
    assert first["completion_criteria"]["behavior"] == "Größe: \U0001f916\x7f"


def test_a_name_that_ml_agents_cannot_send_is_refused():
    named = replace(STEP, parameters=("Höhe_mm",))
    with pytest.raises(InputError, match="`Höhe_mm` has letters that ML-Agents cannot send"):
        export_ml_agents(named)


def test_several_parameters_are_drawn_by_the_index_of_their_box():
    export = export_ml_agents(TWO)
    rows = list(csv.DictReader(io.StringIO(export.files["variant_index.csv"])))
    assert [row["wind_upper"] for row in rows] == ["5.0", "9.0"]
    (found,) = intervals_of(export.files["curriculum.yaml"])
    assert drawn_share(found, 1.0, 2.0) == pytest.approx(0.7, abs=0.006)
    assert "cannot draw several together" in export.notes[0]
    assert "clamp it to 1 " in export.notes[0]


def test_the_table_of_boxes_holds_names_with_commas():
    export = export_ml_agents(replace(TWO, parameters=("g", "wind, m/s")))
    rows = list(csv.DictReader(io.StringIO(export.files["variant_index.csv"])))
    assert [row["wind, m/s_upper"] for row in rows] == ["5.0", "9.0"]


@pytest.mark.skipif(
    "SURMOUNT_MLAGENTS_PYTHON" not in os.environ, reason="needs a Python with mlagents 1.1.0"
)
@pytest.mark.parametrize("curriculum", [STEP, TWO, replace(STEP, parameters=("height: mm # x",))])
def test_the_parser_of_ml_agents_reads_the_files(curriculum, tmp_path):
    export = export_ml_agents(curriculum, behavior="RSTAR")
    paths = []
    for name, text in export.files.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
        paths += [str(tmp_path / name)] if name.endswith(".yaml") else []
    python = os.environ["SURMOUNT_MLAGENTS_PYTHON"]
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    done = subprocess.run(  # noqa: S603
        [python, "-c", PARSE, *paths], capture_output=True, text=True, check=False, env=environment
    )
    assert done.returncode == 0, done.stderr
    read = [json.loads(line) for line in done.stdout.splitlines() if line.startswith('["')]
    assert len(read) == len(paths)
    name, lessons = max(read, key=lambda one: len(one[1]))
    assert name == (curriculum.parameters[0] if len(curriculum.parameters) == 1
                    else "variant_index")  # fmt: skip
    assert len(lessons) == curriculum.n_levels
    assert lessons[-1][2] is None
    written = intervals_of(export.files["curriculum.yaml"])
    for lesson, own in zip(lessons, written, strict=True):
        np.testing.assert_allclose(lesson[1], own)


HOSTILE_NAMES = ("=1+1", "$levels", "__LEVELS__", "a\"b'c\\", "${x", "\U0001f600", "{{ x }}", "%s")


@pytest.mark.parametrize("name", HOSTILE_NAMES)
def test_exported_python_is_valid_for_any_name(name):
    named = replace(
        STEP,
        parameters=(name,),
        groups=(replace(STEP.groups[0], name=name), *STEP.groups[1:]),
        levels=(replace(STEP.levels[0], dominant=name), STEP.levels[1]),
    )
    for kind in ("sb3", "syllabus"):
        (text,) = export_curriculum(named, kind).files.values()
        found = {
            node.targets[0].id: ast.literal_eval(node.value)
            for node in ast.parse(text).body
            if isinstance(node, ast.Assign)
            and isinstance(node.targets[0], ast.Name)
            and node.targets[0].id in ("PARAMETERS", "LEVELS")
        }
        assert found["PARAMETERS"] == [name]
        assert [level["dominant"] for level in found["LEVELS"]] == [name, "difficult"]


@pytest.mark.parametrize("name", ["=1+1", "+1", "-1", "@SUM(A1)"])
def test_no_cell_of_the_table_is_a_formula(name):
    named = replace(
        STEP,
        parameters=(name,),
        groups=(replace(STEP.groups[0], name=name), *STEP.groups[1:]),
        levels=(replace(STEP.levels[0], dominant=name), STEP.levels[1]),
    )
    text = export_curriculum(named, "csv").files["curriculum.csv"]
    cells = [cell for row in csv.reader(io.StringIO(text)) for cell in row]
    assert f"'{name}" in cells
    assert not any(cell.startswith(("=", "+", "-", "@", "\t")) for cell in cells)


def test_the_table_holds_every_probability():
    text = export_curriculum(STEP, "csv").files["curriculum.csv"]
    rows = list(csv.DictReader(io.StringIO(text)))
    for number, level in enumerate(STEP.levels, 1):
        for index, name in enumerate(("easy", "medium", "difficult")):
            share = sum(float(row["weight"]) for row in rows
                        if row["level"] == str(number) and row["group"] == name)  # fmt: skip
            assert share == pytest.approx(level.weights[index])


WITHOUT_SURMOUNT = """
import sys
class Absent:
    def find_spec(name, path, target=None):
        if name.partition(".")[0] == "surmount":
            raise ModuleNotFoundError(name)
sys.meta_path.insert(0, Absent)
import gymnasium, numpy as np
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import DummyVecEnv
import curriculum_sb3 as own
"""


def run_without_surmount(folder, curriculum, program):
    """Run a program beside the file for Stable-Baselines3."""
    text = export_curriculum(curriculum, "sb3").files["curriculum_sb3.py"]
    assert "import surmount" not in text
    assert "from surmount" not in text
    (folder / "curriculum_sb3.py").write_text(text, encoding="utf-8")
    done = subprocess.run(  # noqa: S603
        [sys.executable, "-c", WITHOUT_SURMOUNT + program],
        capture_output=True,
        text=True,
        check=False,
        cwd=folder,
    )
    assert done.returncode == 0, done.stderr


def test_the_file_for_stable_baselines_trains_without_surmount(tmp_path):
    program = """
own.ITERATION_STEPS, own.EXTENSION_STEPS, own.WINDOW_STEPS, own.MAX_EXTENSIONS = 128, 128, 32, 0
seen = []
def make():
    env = gymnasium.make("Pendulum-v1", max_episode_steps=20)
    return own.LevelWrapper(env, lambda inner, task: seen.append((task["gravity"], task["wind"])))
env = DummyVecEnv([make, make])
env.seed(0)
callback = own.LevelCallback()
PPO("MlpPolicy", env, n_steps=64, batch_size=64, device="cpu", seed=0).learn(2000, callback)
assert callback.level == 1
assert len(seen) > 8 and len(set(seen)) == len(seen)
told = np.array(seen)
easy = (told[:, 0] < 1.5) & (told[:, 1] <= 5)
hard = (told[:, 0] >= 1.5) & (told[:, 1] >= 5)
assert (easy | hard).all() and hard.sum() > easy.sum() > 0
env = make()
env.reset(seed=0)
many = []
for _ in range(2000):
    env.reset(); many.append(env.unwrapped is not None and env.task["gravity"] >= 1.5)
assert abs(np.mean(many) - 0.7) < 5 * np.sqrt(0.21 / 2000)
"""
    run_without_surmount(tmp_path, TWO, program)


def test_the_file_for_stable_baselines_learns_in_pieces_and_goes_on_from_saved_progress(tmp_path):
    program = """
import json, warnings
from pathlib import Path
def make():
    env = gymnasium.make("Pendulum-v1", max_episode_steps=20)
    return own.LevelWrapper(env, lambda inner, task: None)
def learner(steps, pieces=1, callback=None):
    callback = callback or own.LevelCallback(verbose=0)
    env = DummyVecEnv([make, make])
    env.seed(0)
    model = PPO("MlpPolicy", env, n_steps=8, batch_size=16, n_epochs=1, device="cpu", seed=0)
    for _ in range(pieces):
        model.learn(steps // pieces, callback, reset_num_timesteps=False)
    return env, callback
# Pieces of 8 decisions, less than half an episode, do what learning at once does.
own.ITERATION_STEPS, own.EXTENSION_STEPS, own.WINDOW_STEPS = 400, 100, 50
for name, pieces in (("whole", 1), ("pieces", 30)):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        learner(480, pieces)[1].save(name)
    (said,) = [str(one.message) for one in caught if "`learn`" in str(one.message)]
    assert "level 1 is tested first after 400 and passes at the earliest after 500" in said
whole, pieces = (json.loads(Path(name).read_text()) for name in ("whole", "pieces"))
assert whole == pieces
assert (whole["level"], whole["iteration"], whole["steps"]) == (0, 1, 480 - 400)
assert [step for step, _ in whole["ended"]] == [40, 40, 80, 80]
# Saved at the second level, and gone on with there.
own.ITERATION_STEPS, own.MAX_EXTENSIONS = 160, 0
warnings.simplefilter("error")
env, callback = learner(192)
assert (callback.level, callback.steps) == (1, 32)
callback.save("levels.json")
again = own.LevelCallback(verbose=0)
again.load("levels.json")
env, again = learner(64, callback=again)
assert env.get_attr("level") == [own.LEVELS[1]] * 2
assert (again.level, again.steps) == (1, 96)
learner(64, callback=again)
for begin, sentence in (
    (lambda: learner(16, callback=again), "All levels are over"),
    (lambda: own.LEVELS.pop() and again.load("levels.json"), "another curriculum"),
):
    try:
        begin()
    except ValueError as error:
        assert sentence in str(error)
    else:
        raise AssertionError(sentence)
"""
    run_without_surmount(tmp_path, STEP, program)


class Start(gymnasium.Env):
    """Its start is two draws of its own generator."""

    observation_space = gymnasium.spaces.Box(0.0, 1.0, (2,))
    action_space = gymnasium.spaces.Discrete(1)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        return self.np_random.random(2), {}


@pytest.mark.parametrize("seeds", [[7] + [None] * 499, range(500)])
def test_tasks_for_stable_baselines_do_not_go_with_the_starts(seeds):
    pytest.importorskip("stable_baselines3", reason="needs Stable-Baselines3")
    space: dict = {}
    exec(export_curriculum(STEP, "sb3").files["curriculum_sb3.py"], space)  # noqa: S102
    env = space["LevelWrapper"](Start(), lambda inner, task: None)
    starts, tasks = np.empty((500, 2)), np.empty(500)
    for episode, seed in enumerate(seeds):
        starts[episode], _ = env.reset(seed=seed)
        tasks[episode] = env.task["height_mm"]
    # What is independent correlates to within 1 / sqrt(500), here four times.
    for start in starts.T:
        assert abs(np.corrcoef(start, tasks)[0, 1]) < 4 / np.sqrt(500)
    env.reset(seed=7)
    again = env.task
    env.reset(seed=7)
    assert env.task == again


def test_levels_for_stable_baselines_go_on_as_the_teacher_does():
    pytest.importorskip("stable_baselines3", reason="needs Stable-Baselines3")
    space: dict = {}
    text = export_curriculum(STEP, "sb3").files["curriculum_sb3.py"]
    exec(text, space)  # noqa: S102
    lengths = {"iteration_steps": 200, "extension_steps": 90, "window_steps": 30,
               "max_extensions": 3}  # fmt: skip
    space |= {name.upper(): value for name, value in lengths.items()}

    class Callback(space["LevelCallback"]):
        training_env = SimpleNamespace(env_method=lambda *_: None)

    levels = [STEP.level_distribution(level) for level in range(STEP.n_levels)]
    iterations = set()
    for seed in range(40):
        rng = np.random.default_rng(seed)
        teacher, callback = LevelTeacher(levels, AdvancementConfig(**lengths)), Callback(0)
        while not teacher.finished:
            ends = np.flatnonzero(rng.random(20) < 0.03) + 1
            rewards = rng.normal(np.sqrt(teacher.status().steps) * (seed % 3 - 1), 1.0, ends.size)
            for end, reward in zip(ends.tolist(), rewards.tolist(), strict=True):
                callback.ended.append((callback.steps + end, reward))
            callback.steps += 20
            callback._on_rollout_end()
            teacher.update_on_rollout(outcome_of(ends, rewards, 20))
            assert callback.level == (teacher.status().level or 3) - 1
        iterations |= {(test.rule, test.decision) for test in teacher.tests}
    assert {rule for rule, _ in iterations} == {"first test", "ratio", "newest gain", "no gain"}
    assert {decision for _, decision in iterations} == {"extend", "advance", "advance at the limit"}


def outcome_of(ends, rewards, steps) -> RolloutOutcome:
    count = ends.size
    return RolloutOutcome(
        rewards=np.zeros(steps),
        episodes=Episodes(
            step=ends,
            variant=np.zeros((count, 1)),
            reward=rewards,
            length=np.ones(count, dtype=int),
            success=np.zeros(count, dtype=bool),
            diverged=np.zeros(count, dtype=bool),
        ),
    )


def test_levels_for_syllabus_never_end_at_their_first_test(monkeypatch):
    stubs = {
        "syllabus.core": {"Curriculum": type("Curriculum", (), {"__init__": lambda *_: None})},
        "syllabus.curricula": {"SequentialCurriculum": None},
        "syllabus.task_space": {"DiscreteTaskSpace": None},
    }
    for name, content in stubs.items():
        monkeypatch.setitem(sys.modules, name, SimpleNamespace(**content))
    space: dict = {}
    exec(export_curriculum(STEP, "syllabus").files["curriculum_syllabus.py"], space)  # noqa: S102
    first, further = space["FIRST_EPISODES"], space["FURTHER_EPISODES"]

    def length(returns) -> int:
        level = space["Level"](space["LEVELS"][0], None)
        for count, value in enumerate(returns, 1):
            level.update_on_episode(value, 10, 0, 0.0)
            if level.is_over():
                return count
        return 0

    assert length(np.zeros(9_000)) == first + further
    assert length(-np.arange(9_000.0)) == first + further
    assert length(np.arange(9_000.0)) == first + space["MAX_EXTENSIONS"] * further
    risen = np.minimum(np.arange(9_000.0), first)
    assert length(risen) == first + further


def test_the_file_for_syllabus_samples_the_first_and_the_last_level_by_their_weights():
    pytest.importorskip("syllabus", reason="needs Syllabus")
    text = export_curriculum(STEP, "syllabus").files["curriculum_syllabus.py"]
    space: dict = {}
    exec(compile(text, "curriculum_syllabus.py", "exec"), space)  # noqa: S102
    curriculum = space["make_curriculum"]()
    boxes = space["BOXES"]

    def share(low, high):
        drawn = np.array(curriculum.sample(k=4000)).ravel()
        return np.mean([boxes[int(task)] == ((low,), (high,)) for task in drawn])

    within = 5 * np.sqrt(0.25 / 4000)
    assert share(21.0, 33.5) == pytest.approx(0.25, abs=within)
    assert share(46.5, 50.0) == pytest.approx(0.05, abs=within)
    # Returns that do not grow end the first level, but not at its first test.
    for _ in range(space["FIRST_EPISODES"] + space["FURTHER_EPISODES"]):
        curriculum.update_on_episode(0.0, 10, 0, 0.0)
    assert share(21.0, 33.5) == pytest.approx(0.2, abs=within)
    assert share(46.5, 50.0) == pytest.approx(0.7, abs=within)


def test_the_file_for_syllabus_is_python_and_holds_the_levels():
    text = export_curriculum(STEP, "syllabus").files["curriculum_syllabus.py"]
    compile(text, "curriculum_syllabus.py", "exec")
    assert "'dominant': 'difficult'" in text


@pytest.mark.parametrize("to", ["ml-agents", "syllabus", "sb3", "csv"])
def test_the_command_writes_files_and_says_what_is_lost(capsys, tmp_path, to):
    STEP.save(tmp_path / "curriculum.json")
    code = run(["export", str(tmp_path / "curriculum.json"), "--to", to, "--out", str(tmp_path)])
    assert code == 0
    out = capsys.readouterr().out
    assert "Written to" in out
    assert len(out.splitlines()) >= 2


def test_an_unknown_format_names_the_nearest():
    with pytest.raises(ConfigError) as caught:
        export_curriculum(STEP, "mlagents")
    assert "`ml-agents`" in caught.value.remedy


@pytest.mark.parametrize("to", ["ml-agents", "syllabus", "sb3", "csv"])
def test_a_curriculum_without_levels_is_refused_by_every_format(capsys, tmp_path, to):
    empty = replace(STEP, levels=())
    empty.save(tmp_path / "curriculum.json")
    out = tmp_path / "out"
    code = run(["export", str(tmp_path / "curriculum.json"), "--to", to, "--out", str(out)])
    assert code == 3
    said = capsys.readouterr().err
    assert "has no levels, so there is nothing to export" in said
    assert "less than 95 % of their trials" in said
    assert not out.exists()


@pytest.mark.parametrize("to", ["syllabus", "sb3", "csv", "onnx", "acting"])
@pytest.mark.parametrize("option", ["--behavior=X", "--threshold=0.2"])
def test_an_option_that_the_format_does_not_use_is_refused(capsys, tmp_path, to, option):
    STEP.save(tmp_path / "curriculum.json")
    out = tmp_path / "out"
    code = run(["export", str(tmp_path / "curriculum.json"), "--to", to, "--out", str(out), option])
    assert code == 2
    said = capsys.readouterr().err
    assert f"`--to {to}` does not use `{option.partition('=')[0]}`" in said
    assert "--to ml-agents" in said
    assert not out.exists()


def test_ml_agents_uses_both_of_its_options(tmp_path):
    STEP.save(tmp_path / "curriculum.json")
    options = ["--to", "ml-agents", "--behavior", "RSTAR", "--threshold", "0.3"]
    assert run(["export", str(tmp_path / "curriculum.json"), *options, "--out", str(tmp_path)]) == 0
    text = (tmp_path / "curriculum.yaml").read_text(encoding="utf-8")
    assert 'behavior: "RSTAR"' in text
    assert "threshold: 0.3\n" in text


def test_what_the_docs_let_unity_write_is_what_their_command_reads(tmp_path, monkeypatch):
    page = (Path(__file__).parents[2] / "docs" / "exports.md").read_text(encoding="utf-8")
    header = re.search(r'WriteLine\("(.*)"\)', page)[1]
    row = re.search(r'\$"(.*)"', page)[1]
    lines = [header]
    for time in (0.0, 0.25):
        for agent in (-1304, 88):
            for episode in (0, 1):
                said = {
                    "GetInstanceID()": agent,
                    "CompletedEpisodes": episode,
                    "stepHeight": 30.5,
                    "Time.time - began": time,
                    "distance": 1.0 - time,
                    "(reached ? 1 : 0)": int(agent > 0 and time > 0),
                }
                line = row
                for name, value in said.items():
                    line = line.replace(f"{{{name}}}", str(value))
                assert "{" not in line
                lines.append(line)
    (tmp_path / "log.csv").write_text("\n".join(lines), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    command = re.search(r"\$ (surmount convert (?:.*\\\n)*.*)", page)[1].replace("\\\n", " ")
    assert run(shlex.split(command)[1:]) == 0
    trials = read_trials(tmp_path / "trials.parquet")
    assert trials.n_trials == 4
    assert trials.success.tolist() == [False, False, True, True]
    assert trials.parameters == ("height_mm",)
    np.testing.assert_array_equal(trials.final("time_s"), 0.25)
    np.testing.assert_array_equal(trials.final("distance_m"), 0.75)
