"""A network of any learner as an ONNX model."""

from __future__ import annotations

from pathlib import Path

from surmount.experiment.origin import config_of, home
from surmount.learn.snapshot import Snapshot
from surmount.learn.stable_config import ALGORITHM


def export_network_onnx(network: Snapshot, source: Path, path: Path) -> None:
    """Write the acting half of a network as one ONNX model.

    Policies of Stable-Baselines3's kind are built again for this, on the spaces of the environment
    that they were trained on; those of Surmount's own PPO need none.

    Parameters
    ----------
    network
        A trained network.
    source
        Its file, which may lie in a run.
    path
        File to write.

    Raises
    ------
    ConfigError, InputError
        If the environment is not known, or the network does not fit it or cannot be written.
    OutputError
        If the file cannot be written.
    """
    if ALGORITHM not in network.record:
        from surmount.learn.onnx_export import export_onnx  # noqa: PLC0415 - loads no environment

        export_onnx(network, path)
        return
    from surmount.learn.stable_export import export_stable_onnx  # noqa: PLC0415

    run, _ = home(source)
    config = config_of(str(source), run=run, network=network)
    env = config.family.trial_env(config.env, 1)
    try:
        export_stable_onnx(network, path, env.single_observation_space, env.single_action_space)
    finally:
        env.close()
