"""Which column of a table holds what: as was said, or by the names of well-known writers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from surmount.core.names import LONGEST_NAME, is_printable
from surmount.trials.columns import FILE_COLUMN, KEYS, TIME, Columns, is_own_column
from surmount.trials.table_problems import Problems

_KNOWN = {
    "network": ("network",),
    "trial": ("trial", "episode_index", "episode", "episode_id"),
    "success": ("success", "is_success", "next.success", "next.done"),
}
"""Names by which a column is found that nobody named, in this order."""
_LEROBOT = "episode_index"
MARK_OF_END = "next.done"
"""LeRobot's mark of an episode's last step, which is an outcome only where some lack it."""
_LEROBOT_COUNTERS = ("frame_index", "index", "task_index", "timestamp")
_REMEDIES = {
    "variant": "Add the task parameter of each row as `variant`, or as `variant.<name>` for each "
    "of several parameters; or name its column with `--variant name=column`.",
    "network": "Add the number or the name of the policy that acted; 0 throughout if there is one.",
    "trial": "Add the number of the repetition among those of its variant and network, or name "
    "its column with `--trial`.",
    "success": "Add the outcome of the trial, 1 or 0, on each of its rows or on its last one, or "
    "name its column with `--success`.",
}


@dataclass(frozen=True, kw_only=True)
class Roles:
    """The column of everything that trials are made of.

    Attributes
    ----------
    parameters, features
        Column by the name of the parameter, or of the feature.
    network, trial, success
        Column, or ``""`` where there is none.
    notes
        What was left out or taken for something, in sentences.
    """

    parameters: Mapping[str, str]
    network: str
    trial: str
    success: str
    features: Mapping[str, str]
    notes: tuple[str, ...]


def find_roles(names: tuple[str, ...], columns: Columns, problems: Problems) -> Roles:
    """Find the columns of a table, noting what is missing.

    Parameters
    ----------
    names
        Of all columns of the table.
    columns
        What was said about them.
    problems
        Where problems are noted.
    """
    present = set(names)
    for name in sorted(column for column in columns.named if not _is_there(column, present)):
        problems.add(f"column `{name}` is missing", f"It has {', '.join(names[:20])}.")
    _check_names(names, problems)
    several = [name for name in names if name.startswith("variant.") and name != "variant."]
    parameters = dict(columns.variant) or {name.removeprefix("variant."): name for name in several}
    if "variant" in present and not columns.variant:
        if several:
            problems.add(
                f"there is both `variant` and `{several[0]}`",
                "Keep `variant` for one task parameter, or `variant.<name>` for each of several.",
            )
        parameters = {"variant": "variant"}
    found = {key: getattr(columns, key) or _known(key, present) for key in KEYS}
    lerobot = found["trial"] == _LEROBOT
    if lerobot and not parameters and "task_index" in present:
        parameters = {"task_index": "task_index"}
    alone = columns.mapped or lerobot or FILE_COLUMN in present
    for key, there in (("variant", parameters), *found.items()):
        by_file = key == "trial" and FILE_COLUMN in present
        if not there and not (key == "network" and alone) and not by_file:
            problems.add(f"column `{key}` is missing", _REMEDIES[key])
    notes: list[str] = []
    features = dict(columns.features)
    if not features:
        taken = {*parameters.values(), *found.values(), FILE_COLUMN}
        left = [name for name in names if name not in taken]
        notes += [_left_out(name, parameters, found) for name in left if is_own_column(name)]
        features = {name: name for name in left if not is_own_column(name)}
        if lerobot:
            features = _lerobot_features(features, notes)
    if not features:
        problems.add("there is no feature column", "Log at least one feature per control step.")
    if found["success"] == MARK_OF_END and not columns.success:
        notes.append(
            "`next.done` was taken for the outcome: trials that ended by themselves count as "
            "successes, those that were cut off as failures. Name another column with "
            "`--success` if that is not so."
        )
    return Roles(
        parameters=parameters,
        network=found["network"],
        trial=found["trial"],
        success=found["success"],
        features=features,
        notes=tuple(notes),
    )


def _is_there(column: str, present: set[str]) -> bool:
    """Whether a column is in the table, as it is or as one entry of a column of lists."""
    stem, _, entry = column.rpartition(".")
    return column in present or (stem in present and entry.isdecimal())


def _known(key: str, present: set[str]) -> str:
    return next((name for name in _KNOWN[key] if name in present), "")


def _left_out(name: str, parameters: Mapping[str, str], found: Mapping[str, str]) -> str:
    """Say why a column is no feature though nothing is read from it: another has its role."""
    columns = [found[name]] if name in found else list(parameters.values())
    role = {"success": "outcome", "variant": "task parameter"}.get(name.partition(".")[0], name)
    verb = " is" if len(columns) == 1 else "s are"
    return f"`{name}` was left out: the {role}{verb} {_listed(columns)}."


def _lerobot_features(features: Mapping[str, str], notes: list[str]) -> dict[str, str]:
    """Keep what a LeRobot data set says about behaviour; its clock is the time of the episode."""
    left_out = [name for name in features if name in _LEROBOT_COUNTERS or name.startswith("next.")]
    kept = {name: name for name in features if name not in left_out}
    if "timestamp" in left_out and TIME not in kept:
        kept = {TIME: "timestamp", **kept}
        left_out.remove("timestamp")
    if left_out:
        notes.append(f"{_listed(left_out)}: counters and marks of LeRobot, left out.")
    return kept


def _check_names(names: tuple[str, ...], problems: Problems) -> None:
    if any(not name.strip() or name == "variant." for name in names):
        problems.add("a column has no name", "Name it, or remove it.")
    unfit = [name for name in names if not is_printable(name)]
    if unfit:
        problems.add(
            f"the name of column {unfit[0][:40]!r} has control characters or over "
            f"{LONGEST_NAME} characters",
            "Give it a short name of letters and digits.",
        )


def _listed(names: list[str]) -> str:
    return ", ".join(f"`{name}`" for name in names)
