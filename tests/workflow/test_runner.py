"""The runner runs what is missing and nothing else, in this process and in others alike."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace

import pytest
import toy_stages
from toy_runs import Observer, graph, run

from surmount.core.errors import IntegrityError, LearningError
from surmount.core.records import read_record
from surmount.workflow.executor import WorkerLostError
from surmount.workflow.graph import Stage, check_graph
from surmount.workflow.in_process import InProcessExecutor
from surmount.workflow.local_processes import ProcessExecutor
from surmount.workflow.monitor import Progress
from surmount.workflow.runner import GraphRunner


@pytest.mark.parametrize("processes", [0, 2])
def test_stages_run_after_their_inputs_and_only_once(tmp_path, processes):
    outcome, observer = run(tmp_path, graph(), processes)
    total = outcome.artefacts["total"].path("n.json")
    assert read_record(total)["n"] == 0 + 1 + 2
    assert observer.started[-1] == "total"
    again, second = run(tmp_path, graph())
    assert second.started == []
    assert len(second.reused) == 4
    assert again.artefacts == outcome.artefacts


def test_what_stands_first_is_finished_first_so_that_a_stop_leaves_whole_parts(tmp_path):
    chains = [
        stage
        for part in range(3)
        for stage in (
            Stage(name=f"part/{part}", kind=toy_stages.KINDS["number"], config={"n": part}),
            Stage(
                name=f"total/{part}",
                kind=toy_stages.KINDS["total"],
                inputs={"parts": (f"part/{part}",)},
            ),
        )
    ]
    run(tmp_path, chains[:1] + chains[4:])
    _, observer = run(tmp_path, chains)
    assert observer.started == ["total/0", "part/1", "total/1"]


def test_only_what_a_change_touches_runs_again(tmp_path):
    run(tmp_path, graph(n=1))
    _, observer = run(tmp_path, graph(n=5))
    # part/0 has configuration 0 either way; the others and their sum differ.
    assert sorted(observer.started) == ["part/1", "part/2", "total"]


def test_seed_and_version_are_part_of_the_key(tmp_path):
    stages = {stage.name: stage for stage in graph()}
    part = stages["part/1"]
    keys = {
        part.key({}),
        replace(part, seed=1).key({}),
        replace(part, kind=replace(part.kind, version=2)).key({}),
        replace(part, config={"n": 2}).key({}),
        replace(part, kind=toy_stages.KINDS["total"]).key({}),
    }
    assert len(keys) == 5


@pytest.mark.parametrize("processes", [0, 1])
def test_a_stopped_stage_goes_on_from_its_checkpoint(tmp_path, processes):
    # It waits at 5 to be stopped, and is stopped once it has told of its first step.
    stages = [Stage(name="count", kind=toy_stages.KINDS["count_slowly"], config={"hold_at": 5})]

    class Stopping(Observer):
        def listen(self, event):
            super().listen(event)
            if isinstance(event.told, Progress):
                runner.stop()

    observer = Stopping()
    make = (lambda listen: ProcessExecutor(1, listen)) if processes else InProcessExecutor
    executor = make(observer.listen)
    runner = GraphRunner(tmp_path, stages, executor, observer)
    outcome = runner.run()
    executor.close()
    assert outcome.interrupted
    assert outcome.artefacts == {}
    resumed, second = run(tmp_path, stages)
    starts = [event.told for event in second.told if isinstance(event.told, str)]
    assert starts in [[f"starts at {done}"] for done in range(1, 6)]
    assert not resumed.interrupted
    assert read_record(resumed.artefacts["count"].path("n.json"))["n"] == 50


@pytest.mark.parametrize("processes", [0, 1])
def test_what_a_stage_finds_wrong_reaches_the_caller_whole(tmp_path, processes):
    stages = [*graph(), Stage(name="bad", kind=toy_stages.KINDS["fail"])]
    with pytest.raises(LearningError) as caught:
        run(tmp_path, stages, processes)
    assert caught.value.remedy == "Lower the learning rate."


@pytest.mark.parametrize("retries", [0, 1])
def test_a_killed_worker_is_reported_once_its_retries_are_used_up(tmp_path, retries):
    stages = [Stage(name="mortal", kind=toy_stages.KINDS["die"], config={"times": 2})]
    observer = Observer()
    executor = ProcessExecutor(1, observer.listen)
    with pytest.raises(WorkerLostError, match="worker process of stage `mortal`") as caught:
        GraphRunner(tmp_path, stages, executor, observer, retries=retries).run()
    executor.close()
    assert "Run the same command again" in caught.value.remedy
    assert observer.lost == [("mortal", True)] * retries + [("mortal", False)]
    assert len(toy_stages.deaths(tmp_path)) == retries + 1


def test_only_the_stage_of_a_killed_worker_runs_again(tmp_path):
    stages = [
        Stage(name="mortal", kind=toy_stages.KINDS["die"], config={"times": 2}),
        Stage(name="count", kind=toy_stages.KINDS["count_slowly"]),
        *graph(),
    ]
    outcome, observer = run(tmp_path, stages, processes=2)
    assert observer.lost == [("mortal", True)] * 2
    assert sorted(observer.started) == sorted(["mortal"] * 2 + [stage.name for stage in stages])
    assert [told for told in observer.sentences if told[0] == "count"] == [("count", "starts at 0")]
    assert read_record(outcome.artefacts["mortal"].path("n.json"))["n"] == 2
    assert not list(tmp_path.rglob("*.tmp"))


def test_workers_that_cannot_start_are_reported_with_the_usual_cause(tmp_path):
    script = tmp_path / "unguarded.py"
    script.write_text(
        "from surmount.workflow.local_processes import ProcessExecutor\n"
        "from surmount.core.errors import SurmountError\n"
        "try:\n    ProcessExecutor(1, print)\n"
        "except SurmountError as error:\n    print(error)\n",
        encoding="utf-8",
    )
    done = subprocess.run(  # noqa: S603
        [sys.executable, str(script)], capture_output=True, text=True, check=False
    )
    assert "if __name__ == '__main__':" in done.stdout


def test_an_input_edited_by_one_byte_stops_the_stages_that_take_it(tmp_path):
    outcome, _ = run(tmp_path, graph()[1:])
    path = outcome.artefacts["part/2"].folder / "n.json"
    path.write_text(path.read_text().replace("2", "3"))
    with pytest.raises(IntegrityError, match=r"part/2.*n\.json"):
        run(tmp_path, graph())


@pytest.mark.parametrize(
    "stages",
    [
        [Stage(name="a", kind=toy_stages.KINDS["total"], inputs={"parts": ("b",)})],
        [Stage(name="a", kind=toy_stages.KINDS["total"], inputs={"parts": ("a",)})],
        [Stage(name="a", kind=toy_stages.KINDS["number"])] * 2,
    ],
)
def test_impossible_graphs_are_refused(stages):
    with pytest.raises(ValueError, match="a"):
        check_graph(stages)
