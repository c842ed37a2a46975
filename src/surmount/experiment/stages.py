"""What stages do: each a function of configuration, seed and input artefacts.

=====================  ====================================================================
stage                  files
=====================  ====================================================================
``initiation``         ``network.safetensors``, ``history.parquet``, ``episodes.parquet``,
                       ``training.json``; ``experience.safetensors`` of learners with a replay
                       buffer
``trials``             ``trials.parquet``
``analysis``           ``analysis.json``, ``curriculum.json``
``curriculum``         as ``initiation``, without experience
``control``            as ``curriculum``
``teach/…``            as ``curriculum``
``statistics``         ``statistics.json``
``evidence``           ``evidence.json``
``test-…``, ``shard/…`` ``trials.parquet``
=====================  ====================================================================
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, replace
from typing import Any

from surmount.analysis.configuration import AnalysisConfig
from surmount.analysis.determination import determine_curriculum
from surmount.analysis.result import Analysis
from surmount.core.configuration import from_record
from surmount.core.records import read_record, write_record
from surmount.core.seeds import derive_seed
from surmount.experiment.history_tables import write_history
from surmount.experiment.task_part import family_and_settings
from surmount.learn.choice import make_actor
from surmount.learn.config import LearnerConfig
from surmount.learn.rollout_config import RolloutConfig
from surmount.learn.rollouts import roll_out
from surmount.learn.snapshot import TRAINED_ON, Snapshot
from surmount.learn.trainer import Checkpointing, Trainer, Training
from surmount.tasks.curriculum import Curriculum
from surmount.tasks.distribution import TaskDistribution
from surmount.tasks.regions import Regions
from surmount.tasks.space import harder_by_success
from surmount.teachers.advancement import AdvancementConfig
from surmount.teachers.catalogue import TeacherContext, TeachersConfig, make_teacher
from surmount.teachers.levels import LevelTeacher
from surmount.teachers.teacher import Teacher
from surmount.teachers.uniform import UniformTeacher
from surmount.trials.table import read_trials, write_trials
from surmount.trials.trials import Trials
from surmount.workflow.graph import StageContext
from surmount.workflow.run_layout import (
    ANALYSIS_FILE,
    CONTROL,
    CURRICULUM_FILE,
    EXPERIENCE_FILE,
    INITIATION,
    NETWORK_FILE,
    SCHEMA,
    TRAINING_FILE,
    TRIALS_FILE,
)
from surmount.workflow.store import Artefact

FIRST = "first_repetition"
"""Key of the configuration of a shard of trials: the number of its first repetition."""


def initiate(context: StageContext) -> None:
    """Train a new network briefly on uniform variants (II-A)."""
    steps = int(context.config["initial_steps"])
    teacher = UniformTeacher(_whole_range(context), steps, label=INITIATION)
    training = train(context, teacher)
    write_training(context, training)
    if training.memory is not None:
        training.memory.save(context.output / EXPERIENCE_FILE)


def run_trials(context: StageContext) -> None:
    """Roll a network out on every variant and log its behaviour (II-A, III-D)."""
    family, settings = family_and_settings(context.config)
    variants = family.space(settings).variants
    config = from_record(RolloutConfig, context.config["trials"])
    network = Snapshot.load(only(context, "network").path(NETWORK_FILE))
    env = family.trial_env(settings, len(variants) * config.repetitions)
    try:
        actor = make_actor(network, env.single_observation_space, env.single_action_space)
        trials = roll_out(
            env,
            actor,
            variants,
            config,
            network=int(context.config["network"]),
            seed=context.seed,
            monitor=context.monitor,
        )
    finally:
        env.close()
    first = int(context.config.get(FIRST, 0))
    trials = replace(trials, repetition=trials.repetition + first)
    write_trials(context.output / TRIALS_FILE, trials)


def join_trials(context: StageContext) -> None:
    """Put the shards of a network's trials together, one after the other."""
    write_trials(context.output / TRIALS_FILE, pooled_trials(context.inputs["shards"]))


def analyse(context: StageContext) -> None:
    """Determine the curriculum from the trials of all networks (II-B)."""
    config = from_record(AnalysisConfig, context.config["analysis"])
    # From the root seed, so that two experiments do not share what is drawn in the analysis.
    config = replace(config, seed=derive_seed(context.seed, config.seed))
    analysis = determine_curriculum(pooled_trials(context.inputs["trials"]), config)
    write_record(context.output / ANALYSIS_FILE, analysis.to_record())
    analysis.curriculum.save(context.output / CURRICULUM_FILE)
    groups = ", ".join(
        f"{group.name} {100 * group.success_rate:.0f} %" for group in analysis.curriculum.groups
    )
    context.monitor.log(
        f"groups by success: {groups}; {analysis.curriculum.n_levels} level(s) to learn"
    )


def learn_levels(context: StageContext) -> None:
    """Train an initial network on, level by level (II-C)."""
    curriculum = Curriculum.load(only(context, "analysis").path(CURRICULUM_FILE))
    teacher = LevelTeacher(
        [curriculum.level_distribution(level) for level in range(curriculum.n_levels)],
        from_record(AdvancementConfig, context.config["advancement"]),
    )
    training = train(
        context, teacher, start=only(context, "network"), regions=Regions.of(curriculum)
    )
    write_training(context, training)


def learn_control(context: StageContext) -> None:
    """Train the same initial network on for as many steps, on uniform variants (III-C)."""
    steps = int(read_record(only(context, "curriculum").path(TRAINING_FILE))["steps"])
    teacher = UniformTeacher(_whole_range(context), steps, label=CONTROL)
    write_training(context, train(context, teacher, start=only(context, "network")))


def learn_by_teacher(context: StageContext) -> None:
    """Train an initial network on by a teacher, for as long as the paper's curriculum took.

    A curriculum without levels took no steps: then no teacher teaches anything.
    """
    family, settings = family_and_settings(context.config)
    space = family.space(settings)
    analysis = Analysis.load(only(context, "analysis").path(ANALYSIS_FILE))
    steps = int(read_record(only(context, "curriculum").path(TRAINING_FILE))["steps"])
    config: Mapping[str, Any] = context.config
    teacher_context = TeacherContext(
        curriculum=analysis.curriculum,
        variants=analysis.variants,
        success_rate=analysis.success_rate,
        whole_range=space.whole_range,
        harder=space.harder
        or harder_by_success(analysis.variants, analysis.success_rate, analysis.axes),
        total_steps=steps,
        seed=context.seed,
        environments=int(config["learner"]["num_envs"]),
        target=family.target(settings),
        analysis=from_record(AnalysisConfig, config["analysis"]),
        advancement=from_record(AdvancementConfig, config["advancement"]),
        teachers=from_record(TeachersConfig, config["teaching"]),
    )
    training = train(
        context,
        make_teacher(str(config["teacher"]), teacher_context)
        if steps
        else UniformTeacher(teacher_context.whole_range, 0),
        start=only(context, "network"),
        regions=Regions.of(analysis.curriculum),
    )
    write_training(context, training)


def pooled_trials(artefacts: tuple[Artefact, ...]) -> Trials:
    """Return the trials of several networks together."""
    return Trials.concatenate([read_trials(artefact.path(TRIALS_FILE)) for artefact in artefacts])


def _whole_range(context: StageContext) -> TaskDistribution:
    family, settings = family_and_settings(context.config)
    return family.space(settings).whole_range


def only(context: StageContext, role: str) -> Artefact:
    """Return the only artefact of a role."""
    (artefact,) = context.inputs[role]
    return artefact


def train(
    context: StageContext,
    teacher: Teacher,
    *,
    start: Artefact | None = None,
    regions: Regions | None = None,
) -> Training:
    """Train under a teacher, going on from the stage's checkpoint if there is one.

    Parameters
    ----------
    context
        The stage.
    teacher
        Gives the tasks.
    start
        What the network to begin from left; ``None`` for a new network.
    regions
        Groups whose weight and success are logged.
    """
    family, settings = family_and_settings(context.config)
    config = from_record(LearnerConfig, context.config["learner"])
    env = family.training_env(settings, config.num_envs)
    try:
        trainer = Trainer(
            env,
            teacher,
            config,
            seed=context.seed,
            start=None if start is None else Snapshot.load(start.path(NETWORK_FILE)),
            memory=Snapshot.load(start.path(EXPERIENCE_FILE))
            if start is not None and EXPERIENCE_FILE in start.files
            else None,
            log_folder=context.logs,
            regions=regions,
            diverged_remedy=family.diverged_remedy,
        )
        return trainer.run(
            context.monitor,
            Checkpointing(
                path=context.checkpoint / "training.safetensors",
                interval_steps=int(context.config["checkpoint_steps"]),
            ),
        )
    finally:
        env.close()


def write_training(context: StageContext, training: Training) -> None:
    """Write the network, its history and a record of the training."""
    history = training.history
    trained_on = {key: context.config[key] for key in ("task", "env")}
    network = training.network
    network = replace(network, record={**network.record, TRAINED_ON: trained_on})
    network.save(context.output / NETWORK_FILE)
    write_history(history, context.output)
    record: dict[str, Any] = {
        "schema": SCHEMA,
        "steps": int(history.steps[-1]) if history.steps.size else 0,
        "episodes": int(history.episodes.step.size),
        "diverged_episodes": int(history.episodes.diverged.sum()),
        "level_tests": [asdict(test) for test in training.tests],
    }
    if training.changes:
        record["changes"] = [change.to_record() for change in training.changes]
    if training.faults.occurred:
        record["faults"] = training.faults.to_record()
    write_record(context.output / TRAINING_FILE, record)
