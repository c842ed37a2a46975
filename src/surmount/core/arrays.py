"""Array types. Shapes stand in docstrings in one vocabulary of axis names.

The words are ``sample``, ``feature``, ``component``, ``variant``, ``parameter``, ``group``,
``level``, ``trial``, ``env`` and ``step``; ``(sample, feature)`` reads as one row per sample.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]
BoolArray = npt.NDArray[np.bool_]
