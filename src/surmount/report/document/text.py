"""Numbers and names as people read them: one way of writing each kind, everywhere on the page."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from surmount.analysis.description import runs
from surmount.core.arrays import FloatArray
from surmount.core.units import stem_and_unit

UNDEFINED = "—"
MINUS = "\N{MINUS SIGN}"
SPACE = "\N{NO-BREAK SPACE}"
"""Between a number and what belongs to it."""
SIGNIFICANCE_LEVEL = 0.05
"""Level of all tests (paper III-E)."""

MOST_RUNS = 4
"""Runs of variants of a group that are written out."""
LONGEST_NAME = 24
"""Characters of a name inside a plot; the page around it has the whole name."""

MOST_DIGITS = 3
"""Digits behind the point of a percentage, at most."""
SMALLEST_P = 0.001
"""Below it a p-value is printed as such."""

_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_NAMES = {"fbem": "FBEM"}


def name_and_unit(name: str) -> tuple[str, str]:
    """Split ``"sprawl_deg"`` into ``("sprawl", "°")``; the unit is empty where there is none."""
    stem, unit = stem_and_unit(name)
    return _NAMES.get(stem, stem.replace("_", " ")), unit


def axis_label(name: str) -> str:
    """Return ``"sprawl (°)"`` for ``"sprawl_deg"``."""
    words, unit = name_and_unit(name)
    return f"{words} ({unit})" if unit else words


def number(value: float | None, digits: int = 3) -> str:
    """Return a number with so many significant digits, without exponent where that is readable."""
    if value is None:
        return UNDEFINED
    if value == 0:
        return "0"
    if 1e-4 <= abs(value) < 1e6:
        text = np.format_float_positional(value, precision=digits, fractional=False, trim="-")
        if abs(value) >= 10**digits:
            text = f"{value:.0f}"
        whole, point, rest = text.partition(".")
        text = f"{int(whole):,}{point}{rest}" if abs(value) >= 1 else text
    else:
        mantissa, _, exponent = f"{value:.{digits - 1}e}".partition("e")
        text = f"{mantissa}·10{str(int(exponent)).translate(_RAISED)}"
    return text.replace("-", MINUS)


def signed(value: float | None, digits: int = 3) -> str:
    """Return a number with its sign, also where it is positive."""
    text = number(value, digits)
    return f"+{text}" if value is not None and value > 0 else text


def integer(value: int) -> str:
    """Return an integer with its thousands separated."""
    return f"{value:,}".replace("-", MINUS)


def percent(share: float | None, digits: int = 0) -> str:
    """Return a share as a percentage; only exact 0 and 1 become 0 % and 100 %."""
    if share is None:
        return UNDEFINED
    least = 10.0**-digits / 2
    if 0 < share < least / 100:
        return f"<{SPACE}{2 * least:g}{SPACE}%"
    if 1 - least / 100 < share < 1:
        return f">{SPACE}{100 - 2 * least:g}{SPACE}%"
    return f"{100 * share:.{digits}f}{SPACE}%".replace("-", MINUS)


def percent_interval(lower: float | None, upper: float | None, digits: int = 0) -> str:
    """Return an interval of shares, ``"12 to 30 %"``, with the digits that tell its ends apart."""
    if lower is None or upper is None:
        return UNDEFINED
    low, high = (f"{100 * end:.{digits}f}".replace("-", MINUS) for end in (lower, upper))
    if low == high and lower < upper and digits < MOST_DIGITS:
        return percent_interval(lower, upper, digits + 1)
    return f"{low} to {high}{SPACE}%"


def interval(lower: float | None, upper: float | None, digits: int = 3) -> str:
    """Return an interval of numbers, ``"0.12 to 0.3"``."""
    if lower is None or upper is None:
        return UNDEFINED
    return f"{number(lower, digits)} to {number(upper, digits)}"


def p_value(p: float | None) -> str:
    """Return ``"p = 0.012"``, or ``"p < 0.001"``, in one piece."""
    if p is None:
        return "p undefined"
    if p < SMALLEST_P:
        return f"p{SPACE}<{SPACE}{SMALLEST_P:g}"
    # As many digits as it takes not to round across the level of the test.
    texts = (f"{p:.{digits}g}" for digits in range(2, 18))
    text = next(text for text in texts if significant(float(text)) == significant(p))
    return f"p{SPACE}={SPACE}{text}"


def significant(p: float | None) -> bool:
    """Return whether a test shows a difference at the level of the paper."""
    return p is not None and p < SIGNIFICANCE_LEVEL


def duration(seconds: float) -> str:
    """Return a time span, ``"2 h 05 min"``, ``"3 min 20 s"`` or ``"4.2 s"``."""
    if seconds < 60:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02d} min" if hours else f"{minutes} min {rest:02d} s"


def variant_label(variant: FloatArray | Sequence[float]) -> str:
    """Return a variant as people write it: ``180`` or ``(180, 0.7)``."""
    parts = [f"{float(value):g}" for value in variant]
    return parts[0] if len(parts) == 1 else f"({', '.join(parts)})"


def variant_range(parameters: Sequence[str], variants: FloatArray) -> str:
    """Return the range of a group's variants, ``"55–95 mm"``, or its runs, ``"55, 70–95 mm"``."""
    if variants.shape[1] != 1:
        return "; ".join(
            f"{name_and_unit(name)[0]} {_range(variants[:, column], name)}"
            for column, name in enumerate(parameters)
        )
    parts = runs(variants[:, 0])
    if len(parts) > MOST_RUNS:
        return _range(variants[:, 0], parameters[0])
    unit = name_and_unit(parameters[0])[1]
    spans = ", ".join(_span(part) for part in parts)
    return f"{spans}{SPACE}{unit}" if unit else spans


def _range(values: FloatArray, parameter: str) -> str:
    unit = name_and_unit(parameter)[1]
    return f"{_span(values)}{SPACE}{unit}" if unit else _span(values)


def _span(values: FloatArray) -> str:
    low, high = float(values.min()), float(values.max())
    return f"{low:g}" if low == high else f"{low:g}–{high:g}"


def listed(words: Sequence[str]) -> str:
    """Return words as a list in a sentence: ``"a, b and c"``."""
    if len(words) < 2:
        return "".join(words)
    return f"{', '.join(words[:-1])} and {words[-1]}"


def short(name: str) -> str:
    """Return a name cut to what fits below an axis."""
    return name if len(name) <= LONGEST_NAME else f"{name[: LONGEST_NAME - 1]}…"


def counted(count: int, singular: str, plural: str | None = None) -> str:
    """Return ``"1 level"`` or ``"3 levels"``."""
    return f"{integer(count)} {singular if count == 1 else plural or singular + 's'}"


def reached(n_reached: int, n_networks: int, median_steps: float | None) -> str:
    """Return how many networks reached a threshold, and the median of their learning steps."""
    count = f"{n_reached} of {n_networks}"
    if median_steps is None:
        return count
    return f"{count}, median {integer(round(median_steps))}"
