"""Running an experiment in an output folder: begin it, or go on with the one that is there."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from surmount.core.configuration import differences, from_record, to_record
from surmount.core.errors import ConfigError, InputError, OutputError
from surmount.core.records import read_record, write_record
from surmount.core.run_layout import INDEX, RUN, SCHEMA, TIMINGS
from surmount.core.store import Artefact, output_errors
from surmount.experiment.config import ExperimentConfig
from surmount.experiment.executors import Executor, InProcessExecutor, Listener, ProcessExecutor
from surmount.experiment.protocol import protocol
from surmount.experiment.provenance import machine, versions
from surmount.experiment.runner import GraphRunner, RunObserver, RunOutcome


def load_config(root: Path) -> ExperimentConfig:
    """Return the configuration of the experiment in a folder.

    Raises
    ------
    OutputError
        If there is no experiment in the folder.
    """
    if not (root / RUN).is_file():
        raise OutputError(
            f"There is no experiment in {root}.",
            remedy="Give the --out folder of a run, or begin one without --resume.",
        )
    return from_record(ExperimentConfig, read_record(root / RUN)["config"])


def begin(root: Path, config: ExperimentConfig) -> None:
    """Claim a folder for an experiment, or recognise the same experiment in it.

    Raises
    ------
    OutputError
        If the folder holds an experiment with another configuration, or other files.
    """
    with output_errors(root):
        root.mkdir(parents=True, exist_ok=True)
        if (root / RUN).exists():
            _require_same(root, config)
        elif any(not path.name.startswith(".") for path in root.iterdir()):
            raise OutputError(
                f"{root} holds files that are not of an experiment.",
                remedy="Choose an --out folder that is empty or does not exist.",
            )
        else:
            record = {
                "schema": SCHEMA,
                "config": to_record(config),
                "versions": versions(),
                "machine": machine(),
            }
            write_record(root / RUN, record)


def make_executor(processes: int, listener: Listener) -> Executor:
    """Return the executor for so many processes; 0 runs everything in this one."""
    if processes < 0:
        raise ConfigError(f"`--processes` is {processes}.", remedy="Give 0 or more.")
    if processes == 0:
        return InProcessExecutor(listener)
    return ProcessExecutor(processes, listener)


def run(
    root: Path,
    config: ExperimentConfig,
    executor: Executor,
    observer: RunObserver,
    *,
    on_ready: Callable[[GraphRunner], None] = lambda _: None,
) -> RunOutcome:
    """Run what is missing of an experiment, and keep an index of its artefacts.

    Parameters
    ----------
    root
        Folder claimed by :func:`begin`.
    config
        The experiment.
    executor, observer
        Where stages run, and who watches.
    on_ready
        Called with the runner before it starts, to let signals stop it.
    """
    runner = GraphRunner(root, protocol(config), executor, _Journal(root, observer))
    on_ready(runner)
    with output_errors(root):
        return runner.run()


class _Journal:
    """Writes down where each stage's files are and how long it took, as soon as it ends."""

    def __init__(self, root: Path, observer: RunObserver) -> None:
        self._root = root
        self._observer = observer
        self._stages: dict[str, str] = {}
        self._seconds = _numbers(root / TIMINGS)

    def stage_reused(self, artefact: Artefact) -> None:
        self._index(artefact)
        self._observer.stage_reused(artefact)

    def stage_started(self, stage: str) -> None:
        self._observer.stage_started(stage)

    def stage_finished(self, artefact: Artefact, seconds: float) -> None:
        self._seconds[artefact.stage] = round(seconds, 3)
        write_record(self._root / TIMINGS, self._seconds)
        self._index(artefact)
        self._observer.stage_finished(artefact, seconds)

    def _index(self, artefact: Artefact) -> None:
        self._stages[artefact.stage] = artefact.folder.relative_to(self._root).as_posix()
        stages = dict(sorted(self._stages.items()))
        write_record(self._root / INDEX, {"schema": SCHEMA, "stages": stages})


def _numbers(path: Path) -> dict[str, float]:
    """Return the timings of earlier calls; a damaged file loses these and nothing else."""
    try:
        record = read_record(path)
    except InputError:
        return {}
    return {name: value for name, value in record.items() if isinstance(value, float)}


def _require_same(root: Path, config: ExperimentConfig) -> None:
    differing = differences(read_record(root / RUN).get("config", {}), to_record(config))
    if differing:
        key, (there, here) = next(iter(differing.items()))
        more = f" and {len(differing) - 1} more" if len(differing) > 1 else ""
        raise OutputError(
            f"{root} was made by another configuration: `{key}` is {there!r} there and {here!r} "
            f"here{more}.",
            remedy="Choose another --out folder, or pass --resume alone to go on with the "
            "configuration of that folder.",
        )
