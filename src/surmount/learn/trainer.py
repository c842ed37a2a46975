"""Training under a teacher, roll-out by roll-out, with checkpoints that go on bit-identically."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from surmount.core.errors import ConfigError, InputError, LearningError
from surmount.envs.family import TaskFamily
from surmount.envs.vector_env import TaskVectorEnv
from surmount.learn.choice import make_learner
from surmount.learn.config import LearnerConfig
from surmount.learn.curriculum_log import log_curriculum
from surmount.learn.faults import MOST_IN_A_ROW, Faults, is_sound_policy
from surmount.learn.history import History
from surmount.learn.loggers import training_logger
from surmount.learn.recorder import Recorder
from surmount.learn.snapshot import Snapshot, Tensors
from surmount.tasks.regions import Regions
from surmount.teachers.changes import Change, changes_of
from surmount.teachers.teacher import LevelTest, RolloutOutcome, Teacher
from surmount.workflow.monitor import Interrupted, Monitor, Progress


@dataclass(frozen=True, kw_only=True, eq=False)
class Training:
    """The outcome of training under one teacher.

    Attributes
    ----------
    network
        Weights, optimiser and normalisation at the end.
    history
        One row per roll-out and one per episode.
    tests
        Level tests made on the way.
    faults
        What went wrong with numbers and was stopped.
    memory
        Past experience that a next training should go on with, where the learner keeps any.
    changes
        What the teacher changed, and why.
    """

    network: Snapshot
    history: History
    tests: tuple[LevelTest, ...]
    faults: Faults
    memory: Snapshot | None = None
    changes: tuple[Change, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Checkpointing:
    """Where and how often training saves itself.

    Attributes
    ----------
    path
        The checkpoint file, overwritten atomically each time.
    interval_steps
        Learning steps between checkpoints; the first roll-out that passes it saves.
    """

    path: Path
    interval_steps: int


class Trainer:
    """A learner on one vector environment, under one teacher.

    Parameters
    ----------
    env
        Environments to learn in.
    teacher
        Gives the task distribution and decides when training is over.
    config
        Which algorithm learns, and its hyper-parameters.
    seed
        Seed of the environments, of exploration and of the order of batches; also of the initial
        weights where no ``start`` is given.
    start
        Weights, optimiser and normalisation to begin from.
    memory
        Past experience to begin with, where the network to begin from left any.
    log_folder
        Where TensorBoard files go; none are written if ``None``.
    regions
        Groups whose weight and success are logged.
    diverged_remedy
        What to do where every episode diverges, as the family of tasks says it.

    Raises
    ------
    ConfigError
        If algorithm, environments and teacher do not fit each other.
    InputError
        If the network to begin from does not fit, or is not finite.
    """

    def __init__(
        self,
        env: TaskVectorEnv,
        teacher: Teacher,
        config: LearnerConfig,
        *,
        seed: int,
        start: Snapshot | None = None,
        memory: Snapshot | None = None,
        log_folder: Path | None = None,
        regions: Regions | None = None,
        diverged_remedy: str = TaskFamily.diverged_remedy,
    ) -> None:
        self._diverged_remedy = diverged_remedy
        self._regions = regions
        self._recorder = Recorder(env)
        self._teacher = teacher
        self._learner = make_learner(self._recorder, config, seed=seed)
        self._model = self._learner.model
        if getattr(teacher, "needs_value_errors", False) and not self._learner.estimates_values:
            raise ConfigError(
                f"The teacher, {teacher.status().label}, needs a critic's value errors, and the "
                f"algorithm {config.algorithm} estimates none.",
                remedy="Choose another teacher, or learn by PPO, A2C or another algorithm with "
                "roll-outs.",
            )
        self._model.set_logger(training_logger(log_folder))
        self._learner.begin(
            None if start is None else start.tensors,
            planned_steps=teacher.status().planned_steps,
        )
        if memory is not None:
            self._learner.remember(memory.tensors, goes_on=False)
        self._history = History(parameters=env.task_parameters)
        self._tests: list[LevelTest] = []
        self._faults = Faults()
        if not is_sound_policy(self._learner.policy):
            raise InputError(
                "The network to begin from has weights that are not finite.",
                remedy="Begin from another network, or train it anew.",
            )

    def run(self, monitor: Monitor, checkpointing: Checkpointing | None = None) -> Training:
        """Train until the teacher is finished.

        Raises
        ------
        Interrupted
            If the monitor asked to stop; the checkpoint then holds everything done so far.
        LearningError
            If updates keep failing, or the physics keeps diverging; the last checkpoint is from
            before.
        """
        try:
            return self._run(monitor, checkpointing)
        finally:
            self._learner.logger.close()

    def _run(self, monitor: Monitor, checkpointing: Checkpointing | None) -> Training:
        for note in self._learner.notes:
            monitor.log(note)
        saved_at = self._resume(checkpointing, monitor)
        self._push_distribution()
        while not self._teacher.finished:
            if monitor.should_stop():
                self._save(checkpointing)
                raise Interrupted
            self._learn_one_rollout(monitor, checkpointing)
            outcome = self._recorder.collect(self._learner.advantages())
            self._require_some_physics(outcome)
            told = len(changes_of(self._teacher))
            test = self._teacher.update_on_rollout(outcome)
            for change in changes_of(self._teacher)[told:]:
                monitor.log(change.sentence)
            self._history.add(outcome, label=self._teacher.status().label)
            self._report(monitor, outcome, test)
            self._push_distribution()
            if checkpointing and self._recorder.steps - saved_at >= checkpointing.interval_steps:
                self._save(checkpointing)
                saved_at = self._recorder.steps
        memory = self._learner.memory()
        return Training(
            network=Snapshot(tensors=self._learner.take(), record=self._learner.record()),
            history=self._history,
            tests=tuple(self._tests),
            faults=self._faults,
            memory=Snapshot(tensors=memory, record={}) if memory else None,
            changes=changes_of(self._teacher),
        )

    def _learn_one_rollout(self, monitor: Monitor, checkpointing: Checkpointing | None) -> None:
        """Collect and update; undo the update where it left nothing sound."""
        faults, learner = self._faults, self._learner
        before = learner.take()
        skipped = learner.learn_one_rollout()
        faults.skipped_updates += skipped
        if skipped:
            monitor.log(
                f"{skipped} update(s) left out at {self._recorder.steps:,} steps: "
                "loss or gradient was not finite, or exploded"
            )
        if learner.is_sound:
            faults.undone_in_a_row = 0
            return
        learner.put(before)
        faults.undone_rollouts += 1
        faults.undone_in_a_row += 1
        monitor.log(f"the roll-out that ended at {self._recorder.steps:,} steps was undone")
        if faults.undone_in_a_row >= MOST_IN_A_ROW:
            saved = checkpointing is not None and checkpointing.path.exists()
            where = f"is {checkpointing.path}" if saved and checkpointing else "was not kept"
            raise LearningError(
                f"Learning was undone {MOST_IN_A_ROW} times in a row, last at "
                f"{self._recorder.steps:,} steps: loss or weights were not finite, or exploded.",
                remedy="Lower `learner.learning_rate` or `learner.max_gradient_norm`, or normalise "
                f"rewards; the last good checkpoint {where}.",
            )

    def _require_some_physics(self, outcome: RolloutOutcome) -> None:
        diverged = outcome.episodes.diverged
        if not diverged.size or not diverged.all():
            self._faults.diverged_in_a_row = 0
            return
        self._faults.diverged_in_a_row += 1
        if self._faults.diverged_in_a_row >= MOST_IN_A_ROW:
            raise LearningError(
                f"Every episode of the last {MOST_IN_A_ROW} roll-outs ended because the physics "
                f"diverged, last at {self._recorder.steps:,} steps.",
                remedy=self._diverged_remedy,
            )

    def _push_distribution(self) -> None:
        if not self._teacher.finished:
            self._recorder.env.set_task_distribution(self._teacher.distribution())

    def _report(self, monitor: Monitor, outcome: RolloutOutcome, test: LevelTest | None) -> None:
        status = self._teacher.status()
        values = self._history.latest()
        logger = self._learner.logger
        for name, value in values.items():
            logger.record(f"surmount/{name}", value)
        finished = self._teacher.finished
        log_curriculum(
            logger,
            distribution=None if finished else self._teacher.distribution(),
            outcome=outcome,
            test=test,
            regions=self._regions,
            status=status,
        )
        if test is not None:
            self._tests.append(test)
            monitor.log(test.sentence)
            measured = test.newest_gain if test.ratio is None else test.ratio
            values |= {} if measured is None else {"eq. 5": measured}
        diverged = int(outcome.episodes.diverged.sum())
        if diverged:
            monitor.log(f"{diverged} episode(s) ended because the physics diverged")
        logger.dump(self._recorder.steps)
        monitor.progress(
            Progress(
                label=status.label, done=status.steps, planned=status.planned_steps, values=values
            )
        )

    def _save(self, checkpointing: Checkpointing | None) -> None:
        if checkpointing is None or not self._learner.has_begun:
            return
        arrays: Tensors = {}
        state = {
            "recorder": self._recorder.state_dict(),
            "history": self._history.state_dict(),
            "loop": self._learner.loop_state(),
            "teacher": self._teacher.state_dict(),
            "tests": [vars(test) for test in self._tests],
            "faults": self._faults.state_dict(),
        }
        record = _split(state, "state", arrays)
        memory = {f"memory/{name}": value for name, value in self._learner.memory().items()}
        tensors = self._learner.take() | memory | arrays
        Snapshot(tensors=tensors, record=record).save(checkpointing.path, sealed=True)

    def _resume(self, checkpointing: Checkpointing | None, monitor: Monitor) -> int:
        """Go on from the checkpoint, if there is one, and return the steps done in it."""
        if checkpointing is None or not checkpointing.path.exists():
            return 0
        saved = Snapshot.load(checkpointing.path, sealed=True)
        state = _join(saved.record, "state", saved.tensors)
        self._learner.put(saved.tensors)
        self._learner.remember(
            {
                name.removeprefix("memory/"): value
                for name, value in saved.tensors.items()
                if name.startswith("memory/")
            },
            goes_on=True,
        )
        self._recorder.load_state_dict(state["recorder"])
        self._history.load_state_dict(state["history"])
        self._teacher.load_state_dict(state["teacher"])
        self._tests = [LevelTest(**test) for test in state["tests"]]
        self._faults = Faults(**state["faults"])
        self._learner.load_loop_state(state["loop"])
        monitor.log(f"went on from the checkpoint at {self._recorder.steps:,} steps")
        return self._recorder.steps


def _split(state: Mapping[str, Any], prefix: str, arrays: Tensors) -> dict[str, Any]:
    """Move the arrays of a state into ``arrays`` and return what remains, fit for JSON."""
    rest: dict[str, Any] = {}
    for name, value in state.items():
        if isinstance(value, np.ndarray):
            arrays[f"{prefix}/{name}"] = value
        elif isinstance(value, Mapping):
            rest[name] = _split(value, f"{prefix}/{name}", arrays)
        else:
            rest[name] = value
    return json.loads(json.dumps(rest))


def _join(rest: Mapping[str, Any], prefix: str, arrays: Mapping[str, Any]) -> dict[str, Any]:
    """Put a state together again that :func:`_split` took apart."""
    state = {
        name: _join(value, f"{prefix}/{name}", arrays) if isinstance(value, dict) else value
        for name, value in rest.items()
    }
    for name, array in arrays.items():
        folder, _, leaf = name.rpartition("/")
        if folder == prefix:
            state[leaf] = array.copy()
    return state
