"""The small protocol as a program of its own, to be killed or run with other variables."""

from __future__ import annotations

import json
import sys
from pathlib import Path

from small import run_small, small_config

if __name__ == "__main__":
    root, options = Path(sys.argv[1]), json.loads(sys.argv[2])
    outcome, watcher = run_small(root, small_config(), **options)
    (root / "watched.json").write_text(
        json.dumps({"lost": watcher.lost, "said": watcher.sentences})
    )
    sys.exit(130 if outcome.interrupted else 0)
