"""Success after the initiation, for many settings of what the paper leaves open.

Decision interval, reward units, start distribution and PPO's settings are not printed, and each
turns the outcome of the initiation from "nothing learnt" to "everything learnt". The setting whose
success after the initiation comes closest to the paper's table 1 is used for everything else; see
``docs/adr/0021-settings-by-initiation.md``. No curriculum is involved.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray, IntArray
from surmount.core.configuration import key_record, override
from surmount.core.errors import ConfigError, InputError
from surmount.core.seeds import derive_seed
from surmount.experiment import kinds
from surmount.experiment.presets import preset
from surmount.experiment.task_part import task_part
from surmount.learn.presets import ML_AGENTS
from surmount.rstar.course.obstacles import OBSTACLES
from surmount.studies.calibration import SCORED, reason_out, score, total_score
from surmount.studies.paper.results import PAPER_RESULTS
from surmount.trials.table import read_trials
from surmount.workflow.graph import Stage
from surmount.workflow.run_layout import TRIALS_FILE
from surmount.workflow.store import Artefact

LEARNERS: Mapping[str, Mapping[str, object]] = {"": {}, "ml-agents": ML_AGENTS}
"""Presets of the learner by name; the default has none."""


@dataclass(frozen=True, kw_only=True)
class Setting:
    """One choice of everything that is open.

    Attributes
    ----------
    name
        Its name in the map.
    changes
        Dotted configuration keys and values, over the paper preset.
    obstacles
        Families to train on.
    networks
        Indices of the networks: the seeds.
    """

    name: str
    changes: Mapping[str, Any]
    obstacles: tuple[str, ...]
    networks: tuple[int, ...]


def read_settings(path: Path) -> list[Setting]:
    """Read a TOML file of settings.

    The table ``common`` holds ``obstacles``, ``networks`` (a number, or a list of indices) and
    ``changes``; each table ``settings.<name>`` may hold its own, ``changes`` being added to the
    common ones. With ``learner = "ml-agents"`` a setting begins from that preset of the learner.

    Raises
    ------
    InputError
        If the file is not of this form.
    """
    try:
        record = tomllib.loads(path.read_text(encoding="utf-8"))
        common = record["common"]
        return [
            Setting(
                name=name,
                changes={
                    **_learner(own.get("learner", common.get("learner", ""))),
                    **common.get("changes", {}),
                    **own.get("changes", {}),
                },
                obstacles=tuple(own.get("obstacles", common.get("obstacles", [*OBSTACLES]))),
                networks=_networks(own.get("networks", common.get("networks", 1))),
            )
            for name, own in record["settings"].items()
        ]
    except (OSError, UnicodeDecodeError, ValueError, KeyError, AttributeError, TypeError) as error:
        raise InputError(
            f"{path} is not a file of settings ({type(error).__name__}: {error}).",
            remedy="Write a TOML file with a table [common] and one [settings.NAME] per setting, "
            "as docs/results/initiation-map/settings.toml has them.",
        ) from error


def _networks(given: int | list[int]) -> tuple[int, ...]:
    return tuple(map(int, given)) if isinstance(given, list) else tuple(range(int(given)))


def _learner(name: str) -> dict[str, Any]:
    """Return what a preset of the learner changes, by dotted keys; nothing for the default."""
    if name not in LEARNERS:
        raise ValueError(f"there is no learner {name!r}")
    return dict(LEARNERS[name])


def trials_stage(setting: str, obstacle: str, network: int) -> str:
    """Return the name of the stage that rolls a network of the map out."""
    return f"trials/{setting}/{obstacle}/network-{network}"


def initiation_stages(settings: list[Setting], scale: str = "paper") -> list[Stage]:
    """Return the graph of a map: an initiation and its trials for every setting and seed.

    Network ``i`` has the same seed under every setting, so that settings are compared in pairs.

    Raises
    ------
    ConfigError
        If a setting changes an unknown key or gives a value that cannot be used.
    """
    graph: list[Stage] = []
    for network in sorted({network for setting in settings for network in setting.networks}):
        for setting in settings:
            if network not in setting.networks:
                continue
            for obstacle in setting.obstacles:
                try:
                    config = override(preset(obstacle, scale, calibrated=False), setting.changes)
                except ConfigError as error:
                    raise ConfigError(
                        f"Setting `{setting.name}`: {error.message}", remedy=error.remedy
                    ) from error
                record = key_record(config)
                name = f"initiation/{setting.name}/{obstacle}/network-{network}"
                task = task_part(config)
                keys = ("learner", "checkpoint_steps", "initial_steps")
                graph.append(
                    Stage(
                        name=name,
                        kind=kinds.INITIATION,
                        config=task | {key: record[key] for key in keys},
                        seed=derive_seed(config.seed, obstacle, "map", network),
                    )
                )
                graph.append(
                    Stage(
                        name=trials_stage(setting.name, obstacle, network),
                        kind=kinds.TRIALS,
                        config=task | {"trials": record["trials"], "network": network},
                        seed=derive_seed(config.seed, obstacle, "map trials", network),
                        inputs={"network": (name,)},
                    )
                )
    return graph


def summarise(
    settings: list[Setting], artefacts: Mapping[str, Artefact]
) -> dict[str, dict[str, Any]]:
    """Return success by variant and network of every setting, and its distance to table 1.

    Returns
    -------
    dict
        By setting: ``obstacles`` (by name: ``variants`` in mm, ``success`` of shape ``(network,
        variant)``, ``groups`` with the paper's success and ours) and ``distance``, see
        :func:`distance_to_table_1`; ``None`` where an obstacle was not trained on. ``score`` and
        ``out`` are those of ADR 23: the sum over obstacles of the logarithm of the probability that
        networks of this setting show what the paper prints, and why the setting is out, if it is.
    """
    summary: dict[str, dict[str, Any]] = {}
    for setting in settings:
        obstacles: dict[str, Any] = {}
        for obstacle in setting.obstacles:
            tried = {
                network: _outcomes(artefacts[trials_stage(setting.name, obstacle, network)])
                for network in setting.networks
                if trials_stage(setting.name, obstacle, network) in artefacts
            }
            if tried:
                obstacles[obstacle] = _on_obstacle(obstacle, tried)
        summary[setting.name] = {
            "obstacles": obstacles,
            "distance": distance_to_table_1(obstacles),
            "score": total_score(obstacles),
            "out": reason_out(obstacles),
        }
    return summary


def _on_obstacle(
    obstacle: str, tried: Mapping[int, tuple[FloatArray, IntArray, int]]
) -> dict[str, Any]:
    variants = next(iter(tried.values()))[0]
    trials = {repetitions for _, _, repetitions in tried.values()}.pop()
    successes = np.stack([won for _, won, _ in tried.values()])
    scored = {"score": score(obstacle, variants, successes, trials)} if obstacle in SCORED else {}
    return {
        "networks": list(tried),
        "variants": variants.tolist(),
        "success": (successes / trials).tolist(),
        "groups": group_success(obstacle, variants, successes / trials),
        **scored,
    }


def group_success(obstacle: str, variants: FloatArray, success: FloatArray) -> list[dict[str, Any]]:
    """Return success in the paper's groups beside the paper's.

    Parameters
    ----------
    obstacle
        Name of the family.
    variants
        Sizes in mm, shape ``(variant,)``.
    success
        Share of successful trials, shape ``(network, variant)``.
    """
    groups: list[dict[str, Any]] = []
    for group in PAPER_RESULTS[obstacle].groups:
        of_network = success[:, group.holds(variants)].mean(axis=1)
        groups.append(
            {
                "name": group.name,
                "low_mm": group.range_mm[0],
                "high_mm": group.range_mm[1],
                "paper": group.after_initiation,
                "mean": float(of_network.mean()),
                "networks": of_network.tolist(),
            }
        )
    return groups


def distance_to_table_1(obstacles: Mapping[str, Any]) -> float | None:
    """Return the mean absolute difference to table 1: over groups, then over obstacles.

    Parameters
    ----------
    obstacles
        By name, records with ``groups`` as :func:`group_success` returns them.

    Returns
    -------
    float or None
        Difference of success rates, between 0 and 1; ``None`` unless all obstacles are there.
    """
    if obstacles.keys() != PAPER_RESULTS.keys():
        return None
    return float(
        np.mean(
            [
                np.mean([abs(group["mean"] - group["paper"]) for group in record["groups"]])
                for record in obstacles.values()
            ]
        )
    )


def _outcomes(artefact: Artefact) -> tuple[FloatArray, IntArray, int]:
    """Return a network's variants in mm, its successes on each, and its trials of each."""
    trials = read_trials(artefact.path(TRIALS_FILE))
    variants, inverse = np.unique(trials.variant[:, 0], return_inverse=True)
    return (
        variants,
        np.bincount(inverse[trials.success], minlength=len(variants)),
        int(np.bincount(inverse)[0]),
    )
