"""Surmount: automatic curriculum determination for reinforcement learning.

What is public stands in ``__init__.pyi`` beside this file; each name is imported when it is first
used, so that ``import surmount`` loads neither PyTorch nor MuJoCo.
"""

import lazy_loader

__version__ = "0.1.0"
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
__all__ += ["__version__"]
