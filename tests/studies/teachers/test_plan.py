"""A comparison follows its plan: costs are charged, networks paired, outcomes read as written."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from surmount.analysis.configuration import AnalysisConfig
from surmount.analysis.determination import determine_curriculum
from surmount.core.errors import ConfigError, InputError
from surmount.core.records import write_record
from surmount.envs.family import NoSettings
from surmount.studies.teachers.figure import differences_figure, network_differences
from surmount.studies.teachers.graph import arms, comparison_stages, recipe
from surmount.studies.teachers.judging import _adjust, against, judge, worst
from surmount.studies.teachers.learning import oracle_tasks, steps_of
from surmount.studies.teachers.outcomes import Arm, Outcome, measured, read_earlier
from surmount.studies.teachers.page import document_of
from surmount.studies.teachers.plan import ORACLE, read_plan
from surmount.studies.teachers.reading import answer, readings, verdict, winners
from surmount.studies.teachers.returns import discounted_returns
from surmount.suite.families import PointMassFamily
from surmount.tasks.space import TaskSpace
from surmount.teachers.catalogue import TEACHERS
from surmount.trials.trials import Trials
from surmount.workflow.monitor import SilentMonitor

PLAN = """
[[task]]
name = "own_point:make_env"
role = "held out"
teachers = ["frontier", "alp-gmm"]
networks = 3
pilot = 2
budget_steps = 9216
[task.common]
"learner.num_envs" = 9
[teaching]
"frontier.target" = 0.5
"""


def plan_of(tmp_path: Path, text: str = PLAN):
    file = tmp_path / "plan.toml"
    file.write_text(text, encoding="utf-8")
    return read_plan(file)


def test_stages_stand_network_by_network_with_one_seed_for_all_teachers(tmp_path):
    plans = plan_of(tmp_path)
    stages = comparison_stages(plans)
    networks = [int(stage.name.rsplit("-", 1)[1]) for stage in stages]
    assert networks == sorted(networks)
    learnt = [stage for stage in stages if stage.kind.name == "study-teacher"]
    assert [stage.config["teacher"] for stage in learnt[:4]] == [
        "uniform", "frontier", "alp-gmm", ORACLE,
    ]  # fmt: skip
    after_the_pilot = [teacher for network, teacher in arms(plans[0]) if network == 2]
    assert after_the_pilot == ["uniform", "frontier", "alp-gmm"]
    seeds = {stage.name.rsplit("-", 1)[1]: set() for stage in learnt}
    for stage in learnt:
        seeds[stage.name.rsplit("-", 1)[1]].add(stage.seed)
    assert all(len(own) == 1 for own in seeds.values())
    assert len(set.union(*seeds.values())) == 3
    assert learnt[1].config["teaching"]["frontier"]["target"] == 0.5
    analyses = [stage for stage in stages if stage.kind.name == "analysis"]
    assert [len(stage.inputs["trials"]) for stage in analyses] == [1, 1, 1]


LOTS = PLAN.replace('["frontier", "alp-gmm"]', '[["frontier"], ["alp-gmm", "uniform"]]')


def test_a_lot_of_teachers_is_run_on_all_networks_before_the_next(tmp_path):
    (plan,) = plan_of(tmp_path, LOTS)
    assert plan.lots == (("uniform", "frontier"), ("alp-gmm",))
    assert list(arms(plan)) == [
        *((network, name) for network in (0, 1) for name in ("uniform", "frontier", ORACLE)),
        (2, "uniform"), (2, "frontier"),
        *((network, "alp-gmm") for network in range(3)),
    ]  # fmt: skip
    taught = [s.config["teacher"] for s in comparison_stages([plan]) if "/teach/" in s.name]
    assert taught == [name for _, name in arms(plan)]


def outcome_of(**networks: int) -> Outcome:
    """Return made-up success of the first so many networks of teachers on three variants."""
    rng = np.random.default_rng(0)
    return Outcome(
        arms={
            name.replace("_", "-"): Arm(success=dict(enumerate(rng.uniform(size=(count, 3)))))
            for name, count in networks.items()
        },
        initial=Arm(success=dict.fromkeys(range(3), np.zeros(3))),
        trial_steps={0: 900, 1: 1100, 2: 1000},
    )


def test_of_a_lot_those_networks_are_judged_that_all_of_it_have(tmp_path):
    (plan,) = plan_of(tmp_path, LOTS)
    outcome = outcome_of(uniform=3, frontier=3, alp_gmm=2)
    del outcome.arm("frontier").success[0]
    record = judge([plan], {plan.label: outcome})
    (task,) = record["tasks"]
    judged = {one["name"]: one["judged"] for one in task["teachers"]}
    assert judged == {"uniform": [0, 1, 2], "frontier": [1, 2], "alp-gmm": [0, 1]}
    assert [one["against"] and one["against"]["networks"] for one in task["teachers"]] == [
        None, 2, 2,
    ]  # fmt: skip
    # Together in one lot, only network 1 is whole; of the headroom alone the reference is told.
    (plan,) = plan_of(tmp_path)
    (task,) = judge([plan], {plan.label: outcome})["tasks"]
    assert [one["judged"] for one in task["teachers"]] == [[1]] * 3
    assert [one["against"] for one in task["teachers"]] == [None] * 3
    assert sorted(task["teachers"][0]["success"]) == ["0", "1", "2"]  # nothing measured is lost
    (task,) = judge([plan], {plan.label: outcome_of(uniform=2, oracle=2)})["tasks"]
    assert task["teachers"][0]["summary"]["networks"] == 2
    page = document_of({"tasks": [judge([plan], {plan.label: outcome})["tasks"][0]]})
    costs = page.sections[1].blocks[0].notes[1]
    assert costs.startswith("Of 9,216 steps trials cost 11\xa0% (10\xa0% to 12\xa0%), paid by f")


def test_networks_measured_elsewhere_are_taken_over_and_not_run_again(tmp_path):
    plans = plan_of(tmp_path)
    elsewhere = outcome_of(uniform=3, frontier=2, alp_gmm=2, oracle=2)
    file = tmp_path / "comparison.json"
    write_record(file, judge(plans, {plans[0].label: elsewhere}))
    found, others = read_earlier(file, plans)
    assert others == []
    taken = found[plans[0].label]
    for name, arm in elsewhere.arms.items():
        for network, rates in arm.success.items():
            np.testing.assert_array_equal(taken.arm(name).success[network], rates)
    assert taken.trial_steps == elsewhere.trial_steps
    left = comparison_stages(plans, known=lambda _, *one: taken.has(*one))
    assert [stage.name.rsplit("/teach/")[1] for stage in left if "/teach/" in stage.name] == [
        "frontier/network-2", "alp-gmm/network-2",
    ]  # fmt: skip
    assert {stage.name[-1] for stage in left} == {"2"}  # whole networks need no initiation either
    # What is measured here goes before; what is only there stays.
    here = Outcome(arms={"frontier": Arm(success={1: np.ones(3), 2: np.ones(3)})})
    joined = here.with_earlier(taken)
    assert [float(rates.mean()) == 1.0 for rates in joined.arm("frontier").success.values()] == [
        False, True, True,
    ]  # fmt: skip
    assert joined.arm("frontier").elsewhere == {0}
    (task,) = judge(plans, {plans[0].label: joined})["tasks"]
    notes = document_of({"tasks": [task]}).sections[1].blocks[0].notes
    assert notes[-1].startswith("6 networks of all teachers together were taken over")
    # Another setting of one teacher is another recipe, of this teacher alone.
    changed = plan_of(tmp_path, PLAN.replace('target" = 0.5', 'target" = 0.4'))
    found, others = read_earlier(file, changed)
    assert sorted(found[plans[0].label].arms) == ["alp-gmm", "oracle", "uniform"]
    assert len(others) == 1
    assert "`frontier`" in others[0]
    assert recipe(plans[0], "frontier") != recipe(changed[0], "frontier")
    longer = plan_of(tmp_path, PLAN.replace("9216", "18432"))
    assert read_earlier(file, longer)[0][plans[0].label].arms == {}


def test_what_is_no_comparison_is_refused_with_a_remedy(tmp_path):
    file = tmp_path / "comparison.json"
    write_record(file, {"schema": 1, "tasks": [{"name": "suite/point-mass"}]})
    with pytest.raises(InputError, match="of this version"):
        read_earlier(file, plan_of(tmp_path))


def test_headroom_alone_runs_the_reference_and_the_oracle_on_the_pilot(tmp_path):
    stages = comparison_stages(plan_of(tmp_path), headroom_only=True)
    taught = [stage.config["teacher"] for stage in stages if stage.kind.name == "study-teacher"]
    assert taught == ["uniform", ORACLE] * 2


@pytest.mark.parametrize(
    ("old", "new", "error"),
    [
        ("pilot = 2", "pilot = 5", ConfigError),
        ('"held out"', '"both"', ConfigError),
        ('"alp-gmm"', '"alpgmm"', ConfigError),
        ("budget_steps = 9216", "", InputError),
        ("[[task]]", "[task]", InputError),
    ],
)
def test_a_plan_that_cannot_be_followed_is_refused(tmp_path, old, new, error):
    with pytest.raises(error):
        plan_of(tmp_path, PLAN.replace(old, new))


def trials_of(lengths: list[int]) -> Trials:
    count = len(lengths)
    variant = np.array([[-3.0, 0.5], [0.0, 8.0], [3.0, 0.5]])[np.arange(count) % 3]
    rng = np.random.default_rng(0)
    starts = np.concatenate([[0], np.cumsum(lengths)])
    return Trials(
        parameters=("gate_position", "gate_width"),
        feature_names=("a", "b"),
        variant=variant,
        network=np.zeros(count, dtype=np.int64),
        repetition=np.arange(count) // 3,
        success=variant[:, 0] == 0.0,
        starts=starts,
        features=rng.normal(np.repeat(variant[:, 0], lengths)[:, None], 1.0, (starts[-1], 2)),
    )


def test_trials_cost_their_steps_and_who_needs_no_groups_pays_nothing():
    assert steps_of(trials_of([5, 7, 3])) == 12
    free = {name for name, entry in TEACHERS.items() if not entry.by_trials}
    assert free == {
        "uniform", "promote-demote", "learning-progress", "learnability", "alp-gmm", "plr",
        "frontier-cells", "sgs", "currot",
    }  # fmt: skip


def test_half_of_the_oracles_tasks_are_what_the_family_wants_or_the_hard_third():
    analysis = determine_curriculum(trials_of([40] * 18), AnalysisConfig(max_components=2))
    family = PointMassFamily()
    target = family.target(None)
    drawn = oracle_tasks(family, None, analysis, target).sample(np.random.default_rng(0), 20_000)
    narrow = (np.abs(np.abs(drawn[:, 0]) - 3) <= 0.02) & (drawn[:, 1] <= 0.52)
    assert narrow.mean() == pytest.approx(0.5, abs=0.02)

    class Ordered(PointMassFamily):
        def space(self, settings):
            space = super().space(settings)
            return TaskSpace(**{**vars(space), "harder": (1, -1)})

    hard = oracle_tasks(Ordered(), None, analysis, None)
    assert hard.weights[1:].sum() == pytest.approx(0.5)
    assert (hard.weights[1:] > 0).sum() == 1
    assert hard.upper[1:][hard.weights[1:] > 0][0, 0] == 3.0  # to the right


def scores(gain: float, networks: int = 20, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    base = rng.uniform(0.3, 0.6, (networks, 1)) + rng.normal(0, 0.05, (networks, 8))
    noise = rng.normal(0, 0.05, (networks, 8))
    return base + gain + noise - noise.mean(), base  # the mean difference is the gain


def task_of(headroom: float, **gains: float) -> dict:
    return {
        "name": "t",
        "title": "Task",
        "role": "held out",
        "planned": {"networks": 20, "pilot": 20, "budget_steps": 1},
        "headroom": against(*scores(headroom), 0),
        "trial_steps": {},
        "ablations": {"frontier-cells": against(*scores(0.1), 0)},
        "teachers": [
            {
                "name": name,
                "title": name,
                "success": {},
                "returns": {},
                "judged": [],
                "elsewhere": [],
                "pays_for_trials": False,
                "published_returns": None,
                "summary": None,
                "against": against(*scores(gain, seed=index), 0),
            }
            for index, (name, gain) in enumerate(gains.items())
        ],
    }


def test_a_difference_is_measured_in_pairs_with_what_it_could_have_found():
    first, second = scores(0.1)
    found = against(first, second, 0)
    assert found["mean"]["estimate"] == pytest.approx((first - second).mean())
    assert found["mean"]["lower"] < 0.1 < found["mean"]["upper"]
    assert found["wilcoxon_p"] < 1e-4
    assert 0 < found["smallest_detectable"] < 0.05
    assert worst(np.array([[0.0, 0.2, 0.4, 1.0, 1.0, 1.0, 1.0, 1.0]])) == pytest.approx([0.1])
    assert against(second, second, 0)["wilcoxon_p"] == 1.0


def test_outcomes_are_read_as_the_plan_says():
    tasks = [task_of(0.2, good=0.1, same=0.0, bad=-0.2), task_of(0.0, good=0.0, bad=0.1)]
    _adjust(tasks)
    read = [{one["name"]: verdict(one) for one in task["teachers"]} for task in tasks]
    assert read[0] == {"good": "helps", "same": "no harm", "bad": "harms"}
    assert read[1] == {"good": "no harm", "bad": "no harm"}  # no headroom: nobody can help
    assert winners(tasks) == ["good"]
    first, second, _ = answer(tasks)
    assert first == (
        "Over uniform tasks these help, and harm on no task that was run: on Task good by +10.0 "
        "points (20 networks)."
    )
    assert "gain nothing sure on Task" in second
    page = document_of({"tasks": tasks})
    assert page.summary == tuple(answer(tasks))
    first_table, second_table, ablations = page.sections[0].blocks[-4:-1]
    # One comparison on the only task with headroom: Holm leaves its p value as it is.
    only = tasks[0]["ablations"]["frontier-cells"]
    assert only["holm_p"] == only["wilcoxon_p"]
    assert len(ablations.rows) == 2
    assert [row[:2] for row in first_table.rows] == [  # the best first
        ("good", "helps"), ("same", "no\xa0harm"), ("bad", "harms"),
    ]  # fmt: skip
    assert [row[1] for row in second_table.rows] == ["no\xa0harm", "no\xa0harm"]


def test_the_figure_of_differences_holds_every_network_of_both():
    task = task_of(0.2, good=0.1)
    reference = {"name": "uniform", "title": "Uniform", "against": None}
    reference["success"] = {"0": [0.2, 0.4], "3": [0.5, 0.5]}
    task["teachers"][0]["success"] = {"0": [0.5, 0.5], "2": [1.0, 1.0], "3": [0.25, 0.5]}
    task["teachers"][0]["judged"] = [0, 3]
    task["teachers"].append(reference)
    found = network_differences(task)
    assert [row[:2] for row in found] == [("good", 0), ("good", 3)]
    assert [row[2] for row in found] == pytest.approx([0.2, -0.125])
    figure = differences_figure([task])
    assert figure.data["network"] == [None, 0, 3]
    assert figure.data["estimate"] == pytest.approx([10.0, 20.0, -12.5], abs=0.1)
    drawn = [row for rows in figure.chart.to_dict()["datasets"].values() for row in rows]
    rings = {row["network"]: row["x"] for row in drawn if "network" in row}
    assert rings == {"network 0": 20.0, "network 3": -12.5}


def test_nobody_wins_where_one_task_is_harmed():
    tasks = [task_of(0.2, good=0.1), task_of(0.2, good=-0.2)]
    _adjust(tasks)
    assert winners(tasks) == []
    first = answer(tasks)[0]
    assert first.startswith("No teacher is shown to help")
    assert "nearest is good with +10.0" in first


def reading_of(ablated: float = 0.0, name: str = "t", **gains: float) -> list[str]:
    task = task_of(0.2, **{name.replace("_", "-"): gain for name, gain in gains.items()})
    task["ablations"] = {"frontier-cells": against(*scores(ablated, seed=9), 0)}
    task["name"] = name
    _adjust([task])
    return readings([task])


def test_each_outcome_is_said_in_the_words_of_the_plan():
    wins = reading_of(frontier=0.1, alp_gmm=0.1)
    assert wins[0] == ("Task: frontier wins here; it is what we recommend on tasks of this kind.")
    assert "not shown to be better than frontier-cells" in wins[1]
    assert wins[1].endswith("pooling by groups is an explanation and not a gain.")
    assert len(wins) == 2
    assert "what that lacks is a gain" in reading_of(0.1, frontier=0.1)[1]
    assert "is behind frontier-cells" in reading_of(-0.1, frontier=0.1)[1]
    (recommended,) = reading_of(frontier=0.0, alp_gmm=0.1)
    assert recommended.startswith("Task: alp-gmm is recommended; groups by behaviour are readable")
    (nobody,) = reading_of(frontier=0.0, alp_gmm=0.0)
    assert "no teacher that was tried is shown to find what the oracle shows" in nobody
    assert reading_of(mastery=0.1, paper=0.0)[-1].startswith("Task: the test that ends levels")
    assert len(reading_of(mastery=0.1, paper=0.1)) == 1
    assert "and there alone" in reading_of(name="rstar/shuffled", frontier=0.1)[-1]
    flat = task_of(0.0, good=0.1)
    _adjust([flat])
    assert readings([flat]) == []  # no headroom: no claim of merit


def test_headroom_alone_is_not_called_a_comparison():
    task = task_of(0.2, good=0.1)
    for teacher in task["teachers"]:
        teacher["against"] = None
    first, second = answer([task])
    assert first == "No teacher has been run beside uniform tasks yet: this is the headroom alone."
    assert second.startswith("On every held-out task that was run, more of the hard tasks")


class SameForce:
    """Pushes all masses alike."""

    def begin(self, trials, rng, *, deterministic):
        assert not deterministic
        return lambda observations: np.tile([0.0, -1.0], (trials, 1))


def test_returns_are_discounted_and_end_with_their_episode():
    family = PointMassFamily()
    tasks = np.array([[0.0, 8.0], [3.0, 0.5]])  # the second one crashes into the wall
    found = discounted_returns(
        family.trial_env(NoSettings(), 2),
        SameForce(),
        tasks,
        discount=0.9,
        seed=3,
        monitor=SilentMonitor(),
    )
    env = family.trial_env(NoSettings(), 2)
    env.reset(seed=3, options={"variant": tasks})
    expected, over = [0.0, 0.0], [False, False]
    for step in range(100):
        _, rewards, terminated, truncated, _ = env.step(np.tile([0.0, -1.0], (2, 1)))
        for mass in range(2):
            if not over[mass]:
                expected[mass] += 0.9**step * rewards[mass]
            over[mass] |= bool(terminated[mass] or truncated[mass])
    assert over == [True, True]
    np.testing.assert_allclose(found, expected, rtol=1e-12)
    assert found[0] > found[1] > 0


def test_returns_on_the_targets_stand_beside_the_published_ones(tmp_path):
    text = PLAN.replace("own_point:make_env", "suite/point-mass")
    text = text.replace('"alp-gmm"]', '"currot"]\ntowards = "target"').replace("held out", "anchor")
    (plan,) = plan_of(tmp_path, text)
    stages = [stage for stage in comparison_stages([plan]) if stage.kind.name == "study-returns"]
    assert len(stages) == 3 * 3 + 2  # and the oracle's on the pilot
    assert not [s for s in comparison_stages(plan_of(tmp_path)) if s.kind.name == "study-returns"]

    class Stored:
        def path(self, name):
            write_record(tmp_path / name, {"schema": 1, "returns": [5.0, 7.0]})
            return tmp_path / name

    name = "suite/point-mass-target/returns/currot/network-1"
    found = measured(plan, {name: Stored()})
    assert found.arm("currot").returns == {1: 6.0}
    (task,) = judge([plan], {plan.label: found})["tasks"]
    assert document_of({"tasks": [task]}).sections[1].blocks[-1].rows == (
        ("CURROT", "1", "6.00", "6.00 to 6.00", "6.0 to 6.3"),
    )
