"""A run folder from Python: its answer, its curriculum, its pictures and its page."""

from __future__ import annotations

from html import escape
from pathlib import Path

from surmount.analysis.result import Analysis
from surmount.core.drawing import Chart
from surmount.core.errors import InputError
from surmount.report.pages import extras_told, write_report
from surmount.report.results import RunResults, read_run
from surmount.tasks.curriculum import Curriculum


class Run:
    """A run of the whole method, finished or not, read from its folder.

    In a notebook its last line shows the answer; a run that goes on is read again by making it
    anew.

    Parameters
    ----------
    folder
        The ``--out`` folder of ``surmount reproduce``, or of an :class:`Experiment`.

    Raises
    ------
    OutputError
        If there is no run in the folder.
    IntegrityError
        If an artefact does not have the content that its hash promises.
    """

    def __init__(self, folder: Path | str) -> None:
        self.folder = Path(folder)
        self._results: RunResults = read_run(self.folder)

    @property
    def task(self) -> str:
        """Name of the task family."""
        return self._results.folder.task

    @property
    def missing(self) -> tuple[str, ...]:
        """Stages that are not finished."""
        return tuple(self._results.folder.missing)

    @property
    def analysis(self) -> Analysis | None:
        """From trials to curriculum; ``None`` before the run came so far."""
        return self._results.analysis

    @property
    def curriculum(self) -> Curriculum | None:
        """What was learnt on; ``None`` before the run came so far."""
        return None if self.analysis is None else self.analysis.curriculum

    def answer(self) -> list[str]:
        """Say whether the curriculum helps, how sure that is, and what it rests on."""
        with extras_told():
            from surmount.report.sections.summary import summary  # noqa: PLC0415 - an extra

            return summary(self._results)

    def plot_learning(self, measure: str = "reward") -> Chart:
        """Draw the learning curves of every network with the levels and their tests.

        Parameters
        ----------
        measure
            ``"reward"`` per step, or ``"success"`` of training episodes.

        Raises
        ------
        InputError
            If nothing was learnt yet, or there is no such measure.
        MissingExtraError
            If the extra ``report`` is not installed.
        """
        with extras_told():
            from surmount.report.figures.learning import learning_curves  # noqa: PLC0415

            if measure not in ("reward", "success"):
                raise InputError(
                    f"There is no measure {measure!r} of learning.",
                    remedy='Ask for "reward" or "success".',
                )
            found = learning_curves(self._results.trainings, measure)
        if found is None:
            raise InputError(
                f"No network of {self.folder} has finished a training yet.",
                remedy="Wait for the first, or look at logs/ by TensorBoard.",
            )
        return found.chart

    def plot_success(self) -> Chart:
        """Draw success per group after the initiation, with the curriculum and without.

        Raises
        ------
        InputError
            If the run has not reached its tests.
        MissingExtraError
            If the extra ``report`` is not installed.
        """
        results = self._results
        if results.analysis is None or results.comparison is None:
            raise InputError(
                f"The run in {self.folder} has not reached the comparison of both arms.",
                remedy="The command that began it goes on where it stopped.",
            )
        with extras_told():
            from surmount.report.figures.success import success_by_group  # noqa: PLC0415

            curriculum = results.analysis.curriculum
            return success_by_group(results.comparison, curriculum, results.tests).chart

    def report(self) -> Path:
        """Write the page of the run and return where it is; see :func:`write_report`."""
        return write_report(self.folder)

    def __repr__(self) -> str:
        """Return the answer in a few lines."""
        return "\n".join((f"Run of {self.task} in {self.folder}", *self.answer()))

    def _repr_html_(self) -> str:
        """Return the same for a notebook."""
        lines = "".join(f"<li>{escape(line)}</li>" for line in self.answer())
        return f"<p>Run of {escape(self.task)} in {escape(str(self.folder))}</p><ul>{lines}</ul>"
