"""``surmount rollout``: a table of trials of policies that were trained elsewhere."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import tyro

from surmount.cli.options import Assignments, ConfigFile, environment_overrides
from surmount.cli.part_progress import PartMonitor, PartProgress
from surmount.core.errors import ConfigError
from surmount.core.printing import say

Policies = Annotated[
    tuple[str, ...], tyro.conf.UseAppendAction, tyro.conf.arg(metavar="MODULE:FUNCTION")
]
Names = Annotated[tuple[str, ...], tyro.conf.UseAppendAction, tyro.conf.arg(metavar="NAME")]


def rollout(
    environment: Annotated[str, tyro.conf.Positional],
    *,
    policy: Policies = (),
    out: Annotated[Path, tyro.conf.arg(metavar="FILE")],
    network: Names = (),
    repetitions: int = 30,
    seed: int = 0,
    deterministic: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False,
    config: ConfigFile = None,
    set: Assignments = (),  # noqa: A002 - the option's name
) -> int:
    """Try policies that were trained elsewhere on every variant, and log their behaviour.

    The table is what `surmount analyze` reads: the policies stand for the initial networks
    (docs/own-environment.md).

    Args:
        environment: The function that makes it, as my_module:make_env, or a registered task.
        policy: The function that returns a policy, as my_module:load: a function from an
            observation to an action, or an object with `predict` as Stable-Baselines3 has it; may
            be repeated.
        out: Table of the trials to write, .parquet or .csv.
        network: What a policy is called in the table, once for each in turn; as --policy names it
            if left out.
        repetitions: Trials of each variant and policy.
        seed: Seed of the environments and of the actions that policies draw.
        deterministic: Ask `predict` for the action without drawing it.
        config: TOML or JSON file of configuration keys to change; see `surmount config`.
        set: Configuration key to change, as key=value; may be repeated; overrides the file.
    """
    from surmount.trials.table_file import require_writable_kind

    named = dict(zip(_names(policy, network), policy, strict=True))
    require_writable_kind(out)

    telling = PartProgress()
    telling(f"loading {', '.join(named)}")  # before what takes seconds to import
    import torch

    from surmount.experiment.presets import configured, preset
    from surmount.learn.brought_policy import by_network, load_policy, policy_trials
    from surmount.learn.rollout_config import RolloutConfig
    from surmount.trials.table import write_trials
    from surmount.workflow.store import output_errors

    torch.set_num_threads(1)  # as in a run: sums would differ in their last bits
    chosen = configured(preset(environment, "paper"), environment_overrides(config, set))
    tries = RolloutConfig(repetitions=repetitions, deterministic=deterministic)
    loaded = {name: load_policy(function) for name, function in named.items()}
    parts = {}
    for name, one in loaded.items():
        with telling:
            parts[name] = policy_trials(
                chosen.family, chosen.env, name, one, tries, seed=seed, monitor=PartMonitor(telling)
            )
        say(f"{name}: {int(parts[name].success.sum())} of {parts[name].n_trials:,} succeeded")
        sys.stdout.flush()
    trials = by_network(parts)
    with output_errors(out.parent):
        write_trials(out, trials)
    say(f"Written to {out}: {trials.n_trials:,} trials")
    return 0


def _names(policies: Sequence[str], names: Sequence[str]) -> tuple[str, ...]:
    """Return what each policy is called, no two alike."""
    if not policies:
        raise ConfigError("There is no policy to try.", remedy="Name one: --policy my_module:load.")
    if names and len(names) != len(policies):
        raise ConfigError(
            f"{len(names)} names are given for {len(policies)} policies.",
            remedy="Give --network once for each --policy, or leave it out.",
        )
    called = tuple(names or policies)
    twice = [name for name, count in Counter(called).items() if count > 1]
    if twice:
        raise ConfigError(
            f"Two policies are called `{twice[0]}`.",
            remedy="Give each a name of its own by --network.",
        )
    return called
