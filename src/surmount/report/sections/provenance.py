"""Section: with what the run was made, so that it can be made again."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, cast

from surmount.report.document.parts import Block, Column, Fold, Paragraph, Section, Table
from surmount.report.document.text import UNDEFINED, duration
from surmount.workflow.run_folder import RunFolder

KEY_DIGITS = 12


def provenance_section(folder: RunFolder) -> Section:
    """Show configuration, seeds, versions, machine, and each stage with its time and hash."""
    config = tuple((key, _text(value)) for key, value in dotted(folder.config))
    blocks: list[Block] = [
        Paragraph(
            text=f"All randomness derives from the seed {folder.config.get('seed', UNDEFINED)}: "
            "every stage draws its own seed from it, from the task and from the name of the "
            "stage, network by network. The same configuration, versions and machine give the same "
            "numbers."
        ),
        _pairs("Versions", ("package", "version"), tuple(folder.versions.items())),
        _pairs("Machine", ("", ""), tuple(folder.machine.items())),
        Fold(
            summary=f"The full configuration ({len(config)} fields)",
            blocks=(_pairs("Configuration", ("key", "value"), config),),
            printed=False,
        ),
        Fold(
            summary=f"All stages ({len(folder.protocol)} finished, {len(folder.missing)} missing)",
            blocks=(stage_table(folder),),
            printed=False,
        ),
    ]
    return Section(anchor="provenance", title="How this was made", blocks=tuple(blocks))


def stage_table(folder: RunFolder) -> Table:
    """Return every stage with its time, and the hash over its files."""
    rows = [
        (
            name,
            duration(folder.seconds[name]) if name in folder.seconds else UNDEFINED,
            artefact.key[:KEY_DIGITS],
            artefact.content_hash[:KEY_DIGITS],
        )
        for name, artefact in folder.protocol.items()
    ]
    rows += [(name, "not finished", UNDEFINED, UNDEFINED) for name in folder.missing]
    return Table(
        label="",
        title="Stages",
        columns=(
            Column(heading="stage"),
            Column(heading="time", numeric=True),
            Column(heading="key"),
            Column(heading="content"),
        ),
        rows=tuple(rows),
        notes=(
            (
                f"Together {duration(folder.protocol_s)} of computing on one core each. The key is "
                "the hash of everything a stage depends on, the content that of the files it wrote "
                "(SHA-256, first digits)."
            ),
            _restarts(folder),
        ),
    )


def _restarts(folder: RunFolder) -> str:
    if not folder.restarts:
        return "No stage lost its worker."
    names = ", ".join(f"{name} ({count})" for name, count in folder.restarts.items())
    return (
        f"Workers that were killed or lost: {sum(folder.restarts.values())}, at {names}. Each "
        "stage went on from its last checkpoint."
    )


def dotted(tree: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Return the leaves of nested records with dotted keys."""
    for key, value in tree.items():
        if isinstance(value, Mapping):
            yield from dotted(cast(Mapping[str, Any], value), f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value


def _text(value: object) -> str:
    if isinstance(value, list):
        return ", ".join(_text(item) for item in cast(list[object], value)) or "none"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        return f"{value:,}"
    return UNDEFINED if value is None else str(value)


def _pairs(title: str, headings: tuple[str, str], rows: tuple[tuple[str, str], ...]) -> Table:
    return Table(
        label="",
        title=title,
        columns=tuple(Column(heading=heading) for heading in headings),
        rows=rows,
    )
