"""Put maps that differ in their root seed into one: ``python pool.py OUT MAP.json [MAP.json ...]``.

Each cell then has the networks of all maps, and is judged again by the same rule. Groups, levels
and length of training stay each map's own.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

from surmount.core.records import write_record
from surmount.experiment.regime_map import judge
from surmount.report.regime_figure import write_regime_figure

SAME = ("kind", "schema", "obstacle", "axes", "hard", "solved")


def pool(folder: Path, *maps: Path) -> None:
    """Write ``regimes.json`` and its figure."""
    records = [json.loads(path.read_text()) for path in maps]
    together: dict[str, Any] = {key: records[0][key] for key in SAME}
    if any(record[key] != together[key] for record in records for key in SAME):
        raise SystemExit("These maps differ in more than their seed.")
    cells = zip(*(record["cells"] for record in records), strict=True)
    together["cells"] = [_cell(together, own) for own in cells]
    folder.mkdir(parents=True, exist_ok=True)
    write_record(folder / "regimes.json", together)
    write_regime_figure(together, folder)
    (folder / "regimes.svg").unlink()
    for cell in together["cells"]:
        shares = [f"{kind} {share:.3f}" for kind, share in cell["all"]["success"].items()]
        print(cell["name"], cell["regime"], *shares, cell["all"]["difference"])


def _cell(record: dict[str, Any], own: tuple[dict[str, Any], ...]) -> dict[str, Any]:
    success = {
        kind: np.concatenate([np.asarray(cell["success"][kind]) for cell in own])
        for kind in own[0]["success"]
    }
    sizes = np.asarray(own[0]["variants"])
    low, high = record["hard"]
    return {
        "name": own[0]["name"],
        "values": own[0]["values"],
        "groups": [cell["groups"] for cell in own],
        "variants": sizes.tolist(),
        "success": {kind: rates.tolist() for kind, rates in success.items()},
        **judge(success, sizes, (low, high), record["solved"]),
    }


if __name__ == "__main__":
    pool(*map(Path, sys.argv[1:]))
