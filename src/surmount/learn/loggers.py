"""Outputs of Stable-Baselines3's logger: TensorBoard, and by request Weights & Biases or MLflow.

Nothing is sent anywhere unless ``SURMOUNT_LOG`` names it, for example ``SURMOUNT_LOG=wandb`` or
``SURMOUNT_LOG=wandb,mlflow``. It is a variable of the environment and not a configuration key,
because where figures are shown changes no result. Where these services are and who one is, their
own variables say (``WANDB_MODE``, ``MLFLOW_TRACKING_URI``, …).
"""

from __future__ import annotations

import importlib
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from stable_baselines3.common.logger import KVWriter, Logger, configure

from surmount.core.errors import ConfigError, InputError, MissingExtraError, SurmountError

VARIABLE = "SURMOUNT_LOG"
PROJECT = "surmount"
"""Project of Weights & Biases, and experiment of MLflow, unless their own variables name one."""


class WandbWriter(KVWriter):
    """Writes scalars to a run of Weights & Biases.

    Parameters
    ----------
    name
        Name of the run.
    """

    def __init__(self, name: str) -> None:
        self._wandb = _imported("wandb")
        project = os.environ.get("WANDB_PROJECT", PROJECT)
        self._run = self._wandb.init(project=project, name=name, reinit="create_new")

    def write(
        self,
        key_values: dict[str, Any],
        key_excluded: dict[str, tuple[str, ...]],
        step: int = 0,
    ) -> None:
        """Write one line of the log."""
        self._run.log(_scalars(key_values, key_excluded, "wandb"), step=step)

    def close(self) -> None:
        """End the run."""
        self._run.finish()


class MlflowWriter(KVWriter):
    """Writes scalars to a run of MLflow.

    Parameters
    ----------
    name
        Name of the run.
    """

    def __init__(self, name: str) -> None:
        mlflow = _imported("mlflow")
        self._client = mlflow.tracking.MlflowClient()
        experiment = os.environ.get("MLFLOW_EXPERIMENT_NAME", PROJECT)
        found = self._client.get_experiment_by_name(experiment)
        identifier = (
            self._client.create_experiment(experiment) if found is None else found.experiment_id
        )
        self._run = self._client.create_run(identifier, run_name=name).info.run_id

    def write(
        self,
        key_values: dict[str, Any],
        key_excluded: dict[str, tuple[str, ...]],
        step: int = 0,
    ) -> None:
        """Write one line of the log."""
        for key, value in _scalars(key_values, key_excluded, "mlflow").items():
            self._client.log_metric(self._run, key, value, step=step)

    def close(self) -> None:
        """End the run."""
        self._client.set_terminated(self._run)


WRITERS = {"wandb": WandbWriter, "mlflow": MlflowWriter}


def training_logger(folder: Path | None) -> Logger:
    """Return a logger with TensorBoard below a folder and what ``SURMOUNT_LOG`` names.

    Parameters
    ----------
    folder
        Of the stage; its last two parts name the run. ``None`` for a logger that writes nothing.

    Raises
    ------
    ConfigError
        If ``SURMOUNT_LOG`` names something else.
    MissingExtraError
        If what it names is not installed.
    InputError
        If what it names begins no run.
    """
    if folder is None:
        return configure(None, [])
    folder.mkdir(parents=True, exist_ok=True)
    logger = configure(str(folder), ["tensorboard"])
    for name in filter(None, os.environ.get(VARIABLE, "").replace(" ", "").split(",")):
        if name not in WRITERS:
            raise ConfigError(
                f"{VARIABLE} names `{name}`.",
                remedy=f"Name {' or '.join(WRITERS)}, or leave it out: TensorBoard is always "
                "written.",
            )
        logger.output_formats.append(_writer(name, "/".join(folder.parts[-2:])))
    return logger


def _writer(service: str, run: str) -> KVWriter:
    try:
        return WRITERS[service](run)
    except SurmountError:
        raise
    except Exception as error:  # whatever its client raises: no key, no network, another version
        raise InputError(
            f"`{service}` begins no run ({type(error).__name__}: {error}).",
            remedy=f"Let a script of its own log there first, or leave it out of {VARIABLE}: "
            "TensorBoard is always written.",
        ) from error


def _imported(module: str) -> Any:
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        raise MissingExtraError(
            f"{VARIABLE} asks for `{module}`, which is not installed.",
            remedy=f"Install it with: pip install {module}",
        ) from error


def _scalars(
    key_values: Mapping[str, Any], key_excluded: Mapping[str, tuple[str, ...]], output: str
) -> dict[str, float]:
    return {
        key: float(value)
        for key, value in key_values.items()
        if isinstance(value, int | float | np.number)
        and output not in (key_excluded.get(key) or ())
    }
