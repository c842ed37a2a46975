"""What is taken away says the same as the curriculum, to the parsers of those who take it."""

from __future__ import annotations

import csv
import io
import json
import os
import re
import subprocess
import sys

import numpy as np
import pytest

from surmount.cli.main import run
from surmount.core.curriculum import Box, Curriculum, Group, Level
from surmount.core.errors import ConfigError, InputError
from surmount.core.trial_table import read_trials
from surmount.exports import (
    Columns,
    export_curriculum,
    export_ml_agents,
    interval_counts,
    read_log,
)


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


def test_several_parameters_are_drawn_by_the_index_of_their_box():
    export = export_ml_agents(TWO)
    rows = list(csv.DictReader(io.StringIO(export.files["variant_index.csv"])))
    assert [row["wind_upper"] for row in rows] == ["5.0", "9.0"]
    (found,) = intervals_of(export.files["curriculum.yaml"])
    assert drawn_share(found, 1.0, 2.0) == pytest.approx(0.7, abs=0.006)
    assert "cannot draw several together" in export.notes[0]


@pytest.mark.skipif(
    "SURMOUNT_MLAGENTS_PYTHON" not in os.environ, reason="needs a Python with mlagents 1.1.0"
)
@pytest.mark.parametrize("curriculum", [STEP, TWO])
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


def test_the_table_holds_every_probability():
    text = export_curriculum(STEP, "csv").files["curriculum.csv"]
    rows = list(csv.DictReader(io.StringIO(text)))
    for number, level in enumerate(STEP.levels, 1):
        for index, name in enumerate(("easy", "medium", "difficult")):
            share = sum(float(row["weight"]) for row in rows
                        if row["level"] == str(number) and row["group"] == name)  # fmt: skip
            assert share == pytest.approx(level.weights[index])


def test_the_file_for_stable_baselines_trains_without_surmount(tmp_path):
    text = export_curriculum(TWO, "sb3").files["curriculum_sb3.py"]
    assert "import surmount" not in text
    assert "from surmount" not in text
    (tmp_path / "curriculum_sb3.py").write_text(text, encoding="utf-8")
    program = """
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
    done = subprocess.run(  # noqa: S603
        [sys.executable, "-c", program],
        capture_output=True,
        text=True,
        check=False,
        cwd=tmp_path,
    )
    assert done.returncode == 0, done.stderr


def test_the_file_for_syllabus_samples_the_levels_by_their_weights(tmp_path, monkeypatch):
    pytest.importorskip("syllabus", reason="needs Syllabus")
    text = export_curriculum(STEP, "syllabus").files["curriculum_syllabus.py"]
    space: dict = {}
    exec(compile(text, "curriculum_syllabus.py", "exec"), space)  # noqa: S102
    curriculum = space["make_curriculum"]()
    drawn = np.array(curriculum.sample(k=4000)).ravel()
    boxes = space["BOXES"]
    easy = np.mean([boxes[int(task)] == ((21.0,), (33.5,)) for task in drawn])
    assert easy == pytest.approx(0.25, abs=5 * np.sqrt(0.25 * 0.75 / 4000))


def test_the_file_for_syllabus_is_python_and_holds_the_levels():
    text = export_curriculum(STEP, "syllabus").files["curriculum_syllabus.py"]
    compile(text, "curriculum_syllabus.py", "exec")
    assert '"dominant": "difficult"' in text


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


def test_a_curriculum_without_levels_has_no_lesson():
    empty = type(STEP)(**{**vars(STEP), "levels": ()})
    with pytest.raises(InputError, match="no levels"):
        export_ml_agents(empty)


LOG = """StepHeight,Episode,Run,Time,X,Reached
21,7,a,0.0,1.0,0
21,7,a,0.1,0.5,1
21,8,a,0.0,1.0,0
35,9,a,0.0,1.0,0
35,9,a,0.1,0.9,0
35,9,b,0.0,1.1,false
35,9,b,0.1,0.2,true
"""


def test_a_log_with_names_of_its_own_becomes_trials(capsys, tmp_path):
    (tmp_path / "log.csv").write_text(LOG, encoding="utf-8")
    out = tmp_path / "trials.csv"
    options = ["--variant", "height_mm=StepHeight", "--feature", "time_s=Time", "--feature",
               "distance_m=X", "--trial", "Episode", "--success", "Reached", "--network",
               "Run"]  # fmt: skip
    code = run(["convert", str(tmp_path / "log.csv"), "--out", str(out), *options])
    assert code == 0
    assert "4 trials on 2 variants, 2 succeeded, 7 rows" in capsys.readouterr().out
    trials = read_trials(out)
    assert trials.parameters == ("height_mm",)
    assert trials.feature_names == ("time_s", "distance_m")
    assert trials.variant[:, 0].tolist() == [21, 21, 35, 35]
    assert trials.success.tolist() == [True, False, False, True]
    assert trials.network.tolist() == [0, 0, 0, 1]
    assert trials.final("distance_m").tolist() == [0.5, 1.0, 0.9, 0.2]


@pytest.mark.parametrize(
    ("text", "columns", "words"),
    [
        (LOG, {"trial": "Episodes"}, "no column `Episodes`"),
        (LOG.replace("35,9,a,0.1", "36,9,a,0.1"), {}, "changes within an episode"),
        (LOG.replace("true", "perhaps"), {}, "other values than true and false"),
    ],
)
def test_a_log_that_cannot_be_read_says_why(tmp_path, text, columns, words):
    path = tmp_path / "log.csv"
    path.write_text(text, encoding="utf-8")
    chosen = {"variant": {"height_mm": "StepHeight"}, "trial": "Episode", "success": "Reached",
              "features": {"x": "X"}, "network": "Run"} | columns  # fmt: skip
    with pytest.raises(InputError, match=words):
        read_log(path, Columns(**chosen))
