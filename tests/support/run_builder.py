"""A run folder written by the shipped functions, with synthetic behaviour instead of a robot."""

from __future__ import annotations

import dataclasses
from dataclasses import asdict
from pathlib import Path

import numpy as np
from synthetic_trials import SyntheticFamily

from surmount.core.configuration import override, to_record
from surmount.core.records import record_hash, write_record
from surmount.experiment.config import ExperimentConfig
from surmount.experiment.evidence import weigh
from surmount.experiment.history_tables import write_history
from surmount.experiment.presets import preset
from surmount.experiment.stages import analyse
from surmount.experiment.statistics import compare
from surmount.experiment.task_part import task_part
from surmount.learn.history import History
from surmount.tasks.curriculum import Curriculum
from surmount.tasks.distribution import TaskDistribution
from surmount.teachers.levels import LevelTeacher
from surmount.teachers.teacher import Episodes, RolloutOutcome, Teacher
from surmount.teachers.uniform import UniformTeacher
from surmount.trials.table import write_trials
from surmount.trials.trials import Trials
from surmount.workflow.artefact_store import ArtefactStore
from surmount.workflow.graph import StageContext, StageFunction
from surmount.workflow.monitor import SilentMonitor
from surmount.workflow.run_layout import ARMS
from surmount.workflow.stage_task import StageTask, execute
from surmount.workflow.store import Artefact

CAP_S = 20.0
SMALL = {
    "networks": 2,
    "initial_steps": 20_000,
    "analysis.components": 3,
    "analysis.bootstrap": 5,
    "analysis.scatter_samples": 60,
    "advancement.iteration_steps": 12_000,
    "advancement.extension_steps": 6_000,
    "advancement.window_steps": 2_000,
}


class RunBuilder:
    """Writes the stages of a run one by one, as the protocol would."""

    def __init__(
        self,
        root: Path,
        *,
        obstacle: str = "step",
        scale: str = "smoke",
        family: SyntheticFamily | None = None,
        success: dict[str, tuple[float, ...]] | None = None,
        changes: dict[str, object] | None = None,
        rollout_steps: int = 2_000,
    ) -> None:
        self.root = root
        self.config: ExperimentConfig = override(
            preset(obstacle, scale), SMALL if changes is None else changes
        )
        self.family = family or SyntheticFamily(sizes=(4, 4, 4), trials=8, steps=25)
        self.success = success or {
            "initiation": (1.0, 0.5, 0.1),
            "curriculum": (1.0, 0.95, 0.9),
            "control": (1.0, 0.7, 0.0),
        }
        self.rollout_steps = rollout_steps
        self.artefacts: dict[str, Artefact] = {}
        record = {
            "schema": 1,
            "config": to_record(self.config),
            "versions": {"python": "3.11.0", "surmount": "0.1.0"},
            "machine": {"system": "Linux x86_64", "processor": "a processor", "cores": "2"},
        }
        write_record(root / "run.json", record)

    def whole(self) -> RunBuilder:
        """Write every stage."""
        self.initiate()
        self.run(
            "analysis", analyse, {"analysis": to_record(self.config.analysis)}, trials="trials"
        )
        self.learn()
        self.compare()
        return self

    def initiate(self) -> None:
        for network in range(self.config.networks):
            teacher = UniformTeacher(self._range(), self.config.initial_steps, label="initiation")
            self._train("initiation", network, teacher)
            self._roll_out("trials", "initiation", network)

    def learn(self) -> None:
        curriculum = self.curriculum()
        levels = [curriculum.level_distribution(level) for level in range(curriculum.n_levels)]
        for network in range(self.config.networks):
            steps = self._train(
                "curriculum", network, LevelTeacher(levels, self.config.advancement)
            )
            control = UniformTeacher(self._range(), steps, label="control")
            self._train("control", network, control)
            for arm in ARMS:
                self._roll_out(f"test-{arm}", arm, network)

    def compare(self) -> None:
        self.run(
            "statistics",
            compare,
            {"cap_s": CAP_S},
            analysis="analysis",
            initiation="trials",
            **{arm: f"test-{arm}" for arm in ARMS},
            **{f"training:{arm}": arm for arm in ARMS},
        )

    def weigh(self) -> None:
        self.run(
            "evidence",
            weigh,
            task_part(self.config),
            analysis="analysis",
            statistics="statistics",
            initiation="trials",
            **{arm: f"test-{arm}" for arm in ARMS},
        )

    def curriculum(self) -> Curriculum:
        return Curriculum.load(self.artefacts["analysis"].path("curriculum.json"))

    def run(self, name: str, function: StageFunction, config: dict[str, object], **roles: str):
        inputs = {
            role: tuple(
                artefact
                for stage, artefact in self.artefacts.items()
                if stage == kind or stage.startswith(f"{kind}/")
            )
            for role, kind in roles.items()
        }
        task = StageTask(
            depot=ArtefactStore(root=self.root),
            name=name,
            key=record_hash([name, self.config.seed]),
            function=function,
            config=config,
            seed=self.config.seed,
            inputs=inputs,
        )
        self.artefacts[name] = execute(task, SilentMonitor())
        self.index()
        return self.artefacts[name]

    def index(self) -> None:
        stages = {
            name: artefact.folder.relative_to(self.root).as_posix()
            for name, artefact in sorted(self.artefacts.items())
        }
        write_record(self.root / "index.json", {"schema": 1, "stages": stages})
        seconds = {name: 1.5 + len(name) for name in stages}
        write_record(self.root / "timings.json", seconds)

    def _range(self) -> TaskDistribution:
        variants = self.trials("initiation").variant
        return TaskDistribution.uniform(("height_mm",), variants.min(axis=0), variants.max(axis=0))

    def trials(self, kind: str) -> Trials:
        """Return synthetic trials of all networks under the names of the robot's features."""
        generated = dataclasses.replace(
            self.family, seed=self.family.seed + len(self.artefacts) * (kind != "initiation")
        ).generate()
        n_variants = sum(self.family.sizes)
        variant = np.repeat(np.arange(n_variants), self.family.trials)
        group = np.repeat(self.family.behaviours, self.family.sizes)[variant]
        rng = np.random.default_rng([*kind.encode(), self.family.seed])
        success = rng.random(generated.n_trials) < np.asarray(self.success[kind])[group]
        features = generated.features.copy()
        final = generated.final("time_s")
        # A failed trial lasts to the cap, a successful one at most 0.9 of it.
        wanted = np.where(success, np.minimum(final, 0.9 * CAP_S), CAP_S)
        features[:, 0] *= np.repeat(wanted / final, generated.lengths)
        features[:, 3] /= 1000.0
        networks, within = self.config.networks, np.arange(self.family.trials)
        return dataclasses.replace(
            generated,
            parameters=("height_mm",),
            feature_names=("time_s", "sprawl_deg", "fbem_deg", "distance_m"),
            features=features,
            success=success,
            network=np.tile(within % networks, n_variants),
            repetition=np.tile(within // networks, n_variants),
        )

    def _roll_out(self, stage: str, kind: str, network: int) -> None:
        trials = self.trials(kind)

        def function(context: StageContext) -> None:
            write_trials(
                context.output / "trials.parquet", trials.select(trials.network == network)
            )

        self.run(f"{stage}/network-{network}", function, {})

    def _train(self, kind: str, network: int, teacher: Teacher) -> int:
        """Train nobody: feed a teacher rewards that rise and level off, and log them."""
        rng = np.random.default_rng([*kind.encode(), network])
        history, tests = History(parameters=("height_mm",)), []
        since_level = steps = 0
        while not teacher.finished:
            since_level += self.rollout_steps
            level = 0.02 * (1 - np.exp(-since_level / (0.3 * self.config.initial_steps)))
            outcome = RolloutOutcome(
                rewards=level - 0.01 + 0.005 * rng.standard_normal(self.rollout_steps),
                episodes=self._episodes(rng, 50 * level, steps),
                steps_before=steps,
            )
            steps += self.rollout_steps
            test = teacher.update_on_rollout(outcome)
            history.add(outcome, label=teacher.status().label)
            if test is not None:
                tests.append(test)
                since_level = 0 if test.decision != "extend" else since_level

        def function(context: StageContext) -> None:
            write_history(history, context.output)
            (context.output / "network.safetensors").write_bytes(b"weights")
            record = {
                "schema": 1,
                "steps": int(history.steps[-1]) if history.steps.size else 0,
                "episodes": int(history.episodes.step.size),
                "diverged_episodes": int(history.episodes.diverged.sum()),
                "level_tests": [asdict(test) for test in tests],
            }
            write_record(context.output / "training.json", record)

        self.run(f"{kind}/network-{network}", function, {})
        return int(history.steps[-1]) if history.steps.size else 0

    def _episodes(self, rng: np.random.Generator, rate: float, steps: int) -> Episodes:
        count = int(rng.integers(0, 8))
        return Episodes(
            step=steps + np.sort(rng.integers(1, self.rollout_steps + 1, count)),
            variant=rng.uniform(100, 200, (count, 1)),
            reward=rate + 0.02 * rng.standard_normal(count),
            length=rng.integers(50, 200, count),
            success=rng.random(count) < rate,
            diverged=rng.random(count) < 0.05,
        )
