"""Many comparisons at once: Holm's adjustment of p values."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from surmount.core.arrays import FloatArray
from surmount.core.errors import InputError


def holm(p_values: npt.ArrayLike) -> FloatArray:
    """Return p values adjusted so that the risk of any false discovery stays at the level.

    S. Holm, "A simple sequentially rejective multiple test procedure" (1979): the smallest is
    multiplied by the number of tests, the next by one less, and so on; none falls below one that
    was smaller. As R's ``p.adjust(p, "holm")``.

    Parameters
    ----------
    p_values
        Shape ``(test,)``, each from 0 to 1.

    Raises
    ------
    InputError
        If one is not.
    """
    p = np.asarray(p_values, dtype=np.float64)
    if p.ndim != 1 or not ((p >= 0) & (p <= 1)).all():
        raise InputError("p values lie from 0 to 1.", remedy="Leave undefined tests out.")
    order = np.argsort(p, kind="stable")
    raised = np.maximum.accumulate(p[order] * np.arange(p.size, 0, -1))
    adjusted = np.empty(p.size)
    adjusted[order] = np.minimum(raised, 1.0)
    return adjusted
