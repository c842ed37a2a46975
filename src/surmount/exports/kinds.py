"""What an export says of axes that are not continuous."""

from __future__ import annotations

from surmount.core.axis import Axis, axes_to_record
from surmount.tasks.curriculum import Curriculum

DRAWS = {
    "continuous": "evenly between its bounds",
    "logarithmic": "evenly in its logarithm between its bounds",
    "integer": "as a whole number from the lower to the upper bound, each alike",
    "categorical": "as one of the names from the lower to the upper bound, each alike",
}
"""How a parameter is drawn, by the kind of its axis."""


def other_axes(curriculum: Curriculum) -> dict[str, Axis]:
    """Return the axes that are not continuous, by parameter."""
    named = zip(curriculum.parameters, curriculum.axes, strict=True)
    others = axes_to_record(curriculum.axes, curriculum.parameters)
    return {name: axis for name, axis in named if name in others}


def notes_on_kinds(curriculum: Curriculum) -> tuple[str, ...]:
    """Return a sentence for each parameter that is not drawn evenly between its bounds."""
    return tuple(
        f"Draw `{name}` {DRAWS[axis.kind]}"
        + (f" ({', '.join(axis.names)})." if axis.names else ".")
        for name, axis in other_axes(curriculum).items()
    )
