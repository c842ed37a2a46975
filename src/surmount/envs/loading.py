"""Finding one's own functions by ``module:function``."""

from __future__ import annotations

import importlib
import inspect
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

from surmount.core.errors import ConfigError, InputError, SurmountError, cause
from surmount.envs.task_env import TaskEnv


def load_make_env(name: str) -> Callable[[], TaskEnv]:
    """Return the function that makes an environment; errors as of :func:`load_function`."""
    return cast(Callable[[], TaskEnv], load_function(name, example="my_module:make_env"))


def load_function(name: str, *, example: str) -> Callable[..., Any]:
    """Return the function that a name stands for.

    The module is looked for where Python looks, and in the working folder.

    Parameters
    ----------
    name
        As ``module:function``.
    example
        How such a name is written, for the sentence of an error.

    Raises
    ------
    ConfigError
        If there is no such module or function, or a file is named instead of a module.
    InputError
        If the module fails while it is imported.
    SurmountError
        If the module raises one while it is imported: it is handed on.
    """
    module_name, _, function_name = name.rpartition(":")
    if not module_name or not function_name:
        raise ConfigError(f"`{name}` is not a function.", remedy=f"Write it as {example}.")
    if module_name.endswith(".py") or "/" in module_name or "\\" in module_name:
        file = Path(module_name)
        spelling = f"{file.stem}:{function_name}"
        raise ConfigError(
            f"`{module_name}` is a file, not a module.",
            remedy=f"Write it as {spelling}."
            if file.parent == Path()
            else f"Write it as {spelling}, and call Surmount in the folder {file.parent}.",
        )
    here = str(Path.cwd())
    if here not in sys.path:
        sys.path.insert(0, here)  # workers inherit it
    try:
        module = importlib.import_module(module_name)
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] != module_name.partition(".")[0]:
            raise InputError(
                f"`{module_name}` needs `{error.name}`, which is not installed.",
                remedy=f"Install it, or call Surmount where `import {error.name}` works.",
            ) from error
        raise ConfigError(
            f"There is no module `{module_name}`.",
            remedy="Call Surmount in the folder of its file, or install it.",
        ) from error
    except SurmountError:
        raise
    except (Exception, SystemExit) as error:
        raise InputError(
            f"`{module_name}` fails while it is imported ({cause(error)}).",
            remedy=f"Let `python -c 'import {module_name}'` work first.",
        ) from error
    function = getattr(module, function_name, None)
    if not callable(function):
        names = [key for key, value in vars(module).items() if inspect.isfunction(value)]
        raise ConfigError(
            f"`{module_name}` has no function `{function_name}`.",
            remedy=f"It has {', '.join(names) or 'none'}.",
        )
    return function
