"""Surmount: automatic curriculum determination for reinforcement learning.

What is public stands in ``__init__.pyi`` beside this file; each name is imported when it is first
used, so that ``import surmount`` loads neither PyTorch nor MuJoCo. A name that needs a package
which is not installed says which extra brings it.
"""

from typing import Any

import lazy_loader

__version__ = "0.1.0"
_find, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
__all__ += ["__version__"]


def __getattr__(name: str) -> Any:
    try:
        return _find(name)
    except ModuleNotFoundError as error:
        from surmount.core.extras import missing_extra  # noqa: PLC0415 - only for this sentence

        told = missing_extra(error)
        if told is None:
            raise
        raise told from error
