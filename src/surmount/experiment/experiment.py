"""An experiment in a folder: begin it, go on with it, draw its page."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Self

from rich.console import Console

from surmount.analysis.result import Analysis
from surmount.core.errors import OutputError
from surmount.core.printing import say
from surmount.core.records import read_record
from surmount.experiment.config import ExperimentConfig, fingerprinted
from surmount.experiment.films import films
from surmount.experiment.presets import configured
from surmount.experiment.presets import preset as preset_of
from surmount.experiment.protocol import protocol
from surmount.experiment.running import begin, load_config, refuse_other
from surmount.experiment.teaching import comparison_graph, require_fit, with_earlier
from surmount.report.pages import write_report
from surmount.report.teachers_page import write_teachers_report
from surmount.tasks.curriculum import Curriculum
from surmount.teachers.catalogue import TeachersConfig
from surmount.workflow.console import SafeConsole
from surmount.workflow.executor import RETRIES
from surmount.workflow.executors import make_executor
from surmount.workflow.graph import Stage
from surmount.workflow.journal import Journal
from surmount.workflow.progress import run_graph
from surmount.workflow.run_folder import RunFolder, open_run
from surmount.workflow.run_layout import (
    ANALYSIS,
    ANALYSIS_FILE,
    COMPARISON,
    COMPARISON_FILE,
    CURRICULUM_FILE,
    STATISTICS,
    STATISTICS_FILE,
)
from surmount.workflow.runner import RunOutcome
from surmount.workflow.store import sole_user


class Experiment:
    """The protocol of the paper for one family of tasks, in one folder.

    ::

        experiment = Experiment.begin("my_module:make_env", "runs/mine", preset="smoke")
        experiment.run()
        experiment.report()

    Worker processes are begun anew: in a script, what calls :meth:`run` stands below
    ``if __name__ == "__main__":``.

    Parameters
    ----------
    config
        The configuration.
    folder
        Folder for everything that the experiment makes; it need not exist.
    """

    def __init__(self, config: ExperimentConfig, folder: Path | str) -> None:
        self.folder = Path(folder)
        self.config = config

    @classmethod
    def begin(
        cls,
        task: str,
        folder: Path | str,
        *,
        preset: str = "smoke",
        changes: Mapping[str, Any] | None = None,
    ) -> Self:
        """Return an experiment on a task.

        Parameters
        ----------
        task
            Name of a registered family of tasks, or ``module:function``.
        folder
            Folder for everything that it makes.
        preset
            ``"smoke"`` or ``"paper"``.
        changes
            Dotted configuration keys and values, such as ``{"learner.learning_rate": 1e-4}``.

        Raises
        ------
        ConfigError
            If the task, the preset or a key is unknown, or a value cannot be used.
        """
        return cls(configured(preset_of(task, preset), changes or {}), folder)

    @classmethod
    def open(cls, folder: Path | str) -> Self:
        """Return the experiment that is in a folder.

        Raises
        ------
        OutputError
            If there is none.
        """
        return cls(load_config(Path(folder)), folder)

    def run(
        self,
        *,
        executor: str = "processes",
        processes: int | None = None,
        address: str | None = None,
        store: str | None = None,
        retries: int = RETRIES,
        console: Console | None = None,
        amend: bool = False,
    ) -> RunOutcome:
        """Run what is missing, with progress; Ctrl-C saves and stops.

        Finished stages are kept, and training goes on from its last checkpoint to the same bytes.

        Parameters
        ----------
        executor
            ``"processes"``, ``"in-process"`` or ``"ray"``.
        processes
            Worker processes of one thread each; one per core if None, 0 for none.
        address
            Head of a running Ray cluster.
        store
            URL of an object store that keeps the same stages as the folder.
        retries
            How often a stage is run again after its worker was lost.
        console
            Where progress is shown.
        amend
            Whether the configuration in the folder may be changed, as far as no finished stage
            depends on what changes.

        Raises
        ------
        OutputError
            If the folder holds another experiment or something else, or cannot be written.
        SurmountError
            What a stage found wrong.
        """
        return self._run(
            protocol,
            executor=executor,
            processes=processes,
            address=address,
            store=store,
            retries=retries,
            console=console,
            amend=amend,
        )

    def resume(self, **where: Any) -> RunOutcome:
        """Go on with what is in the folder; see :meth:`run` for the arguments.

        Raises
        ------
        OutputError
            If there is no experiment in the folder, or another one.
        """
        load_config(self.folder)
        return self.run(amend=True, **where)

    def compare(
        self, teachers: Sequence[str], *, settings: TeachersConfig | None = None, **where: Any
    ) -> RunOutcome:
        """Train the same initial networks on by several teachers, too, at equal budgets.

        Teachers that an earlier comparison in the folder finished stay in it.

        Parameters
        ----------
        teachers
            Names of teachers, see :data:`surmount.TEACHERS`; the paper's and the uniform one are
            always among them.
        settings
            The teachers' own settings.
        **where
            As :meth:`run` takes them.

        Raises
        ------
        ConfigError
            If a teacher is unknown, or needs a critic and the learner has none.
        """
        require_fit(self.config, teachers)
        names, chosen = with_earlier(self.folder, teachers, settings or TeachersConfig())
        return self._run(lambda config: comparison_graph(config, names, chosen), **where)

    def report(self, *, films_too: bool = True, say: Callable[[str], None] = say) -> Path:
        """Draw the page of the run, finished or not, and return its path.

        Parameters
        ----------
        films_too
            Whether to draw films first, where the family knows how to.
        say
            Told of films.
        """
        if films_too:
            films(self.folder, say, own=True)
        compared = self.found.stages.get(COMPARISON)
        if compared is not None:
            write_teachers_report(read_record(compared.path(COMPARISON_FILE)), self.folder)
        return write_report(self.folder)

    @property
    def found(self) -> RunFolder:
        """What the folder holds."""
        return open_run(self.folder)

    @property
    def analysis(self) -> Analysis:
        """The analysis that gave the curriculum.

        Raises
        ------
        OutputError
            If the run has not come so far.
        """
        return Analysis.load(self._file(ANALYSIS, ANALYSIS_FILE))

    @property
    def curriculum(self) -> Curriculum:
        """The curriculum.

        Raises
        ------
        OutputError
            If the run has not come so far.
        """
        return Curriculum.load(self._file(ANALYSIS, CURRICULUM_FILE))

    @property
    def statistics(self) -> dict[str, Any]:
        """Both arms compared, as a record.

        Raises
        ------
        OutputError
            If the run has not come so far.
        """
        return read_record(self._file(STATISTICS, STATISTICS_FILE))

    @property
    def comparison(self) -> dict[str, Any]:
        """Teachers compared at equal budgets, as a record.

        Raises
        ------
        OutputError
            If :meth:`compare` has not come so far.
        """
        return read_record(self._file(COMPARISON, COMPARISON_FILE))

    def _file(self, stage: str, name: str) -> Path:
        artefact = self.found.stages.get(stage)
        if artefact is None:
            raise OutputError(
                f"The run in {self.folder} has not come to its stage `{stage}`.",
                remedy="Go on with `run()`.",
            )
        return artefact.path(name)

    def _run(
        self,
        graph: Callable[[ExperimentConfig], list[Stage]],
        *,
        executor: str = "processes",
        processes: int | None = None,
        address: str | None = None,
        store: str | None = None,
        retries: int = RETRIES,
        console: Console | None = None,
        amend: bool = False,
    ) -> RunOutcome:
        self.config = fingerprinted(self.config)
        stages = graph(self.config)
        amended = graph if amend else None
        refuse_other(self.folder, self.config, amended)
        with sole_user(self.folder):
            begin(self.folder, self.config, amended)
            return run_graph(
                self.folder,
                stages,
                lambda listener: make_executor(processes, listener, kind=executor, address=address),
                console or SafeConsole(),
                store=store,
                retries=retries,
                observed_by=lambda display: Journal(self.folder, display),
            )
