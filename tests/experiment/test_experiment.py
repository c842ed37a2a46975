"""An experiment is begun, run, resumed and reported from Python as from the command line."""

from __future__ import annotations

import io
import threading

import pytest
from rich.console import Console
from small import SMALL

import surmount
from surmount.core.errors import OutputError


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    folder = tmp_path_factory.mktemp("experiment") / "run"
    changes = SMALL | {"networks": 1}
    experiment = surmount.Experiment.begin("narrow-channel", folder, changes=changes)
    told = io.StringIO()
    outcome = experiment.run(processes=0, console=Console(file=told, width=200))
    return experiment, outcome, told.getvalue()


def test_a_run_from_python_finishes_every_stage_and_tells_of_its_progress(finished):
    experiment, outcome, told = finished
    assert not outcome.interrupted
    assert experiment.found.finished
    assert "initiation/network-0: finished in" in told


def test_what_a_run_found_is_at_hand(finished):
    experiment, _, _ = finished
    names = [group.name for group in experiment.curriculum.groups]
    assert names == [group.name for group in experiment.analysis.groups]
    assert experiment.statistics["groups"] == names


def test_a_folder_is_opened_with_its_own_configuration_and_kept(finished):
    experiment, _, _ = finished
    again = surmount.Experiment.open(experiment.folder)
    assert again.config == experiment.config
    told = io.StringIO()
    assert not again.resume(processes=0, console=Console(file=told, width=200)).interrupted
    assert "kept from an earlier call" in told.getvalue()


def test_the_page_is_drawn(finished):
    experiment, _, _ = finished
    page = experiment.report(films_too=False)
    assert page == experiment.folder / "report.html"
    assert "RSTAR and the narrow channel" in page.read_text(encoding="utf-8")


def test_resuming_where_nothing_is_and_asking_for_what_is_not_there_is_told(tmp_path):
    experiment = surmount.Experiment.begin("step", tmp_path / "none", changes=SMALL)
    with pytest.raises(OutputError, match="There is no experiment"):
        experiment.resume()
    with pytest.raises(OutputError, match="There is no run"):
        _ = experiment.curriculum


def test_a_run_may_be_begun_in_another_thread_as_notebooks_do(tmp_path):
    changes = SMALL | {"networks": 1, "initial_steps": 0}
    experiment = surmount.Experiment.begin("low-entrance", tmp_path / "run", changes=changes)
    errors: list[BaseException] = []

    def work() -> None:
        try:
            experiment.run(processes=0, console=Console(file=io.StringIO()))
        except BaseException as error:  # noqa: BLE001 - whatever it is, the test tells it
            errors.append(error)

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert not [error for error in errors if isinstance(error, ValueError)]
