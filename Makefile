# Two commands set everything up: `make demo` and `make test`. The environment is `.venv`.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready
DEMO_OUT ?= out/demo
# The obstacle that is learnt soonest.
DEMO_OBSTACLE ?= low-entrance

export OMP_NUM_THREADS ?= 1

.PHONY: demo test test-slow nightly check audit bench docs vega clean

demo: $(READY)  ## the whole method on one obstacle at reduced scale, with a report at the end
	$(BIN)/surmount reproduce $(DEMO_OBSTACLE) --preset smoke --out $(DEMO_OUT)

test: $(READY)  ## all checks and the fast tests
	$(MAKE) --no-print-directory check
	$(BIN)/pytest -m "not slow" --numprocesses auto --dist loadfile

test-slow: $(READY)  ## learning and soak tests, nightly
	$(BIN)/pytest -m slow

nightly: $(READY)  ## all tests with new draws, 100,000 fuzzed cases, soaks of kills, stores and disks; prints what repeats a failure
	HYPOTHESIS_PROFILE=nightly $(BIN)/pytest -m "not slow" --numprocesses auto --dist loadfile
	HYPOTHESIS_PROFILE=nightly $(BIN)/pytest -m slow
	HYPOTHESIS_PROFILE=nightly SURMOUNT_FUZZ_CASES=100000 $(BIN)/pytest tests/test_fuzz.py --numprocesses auto
	$(BIN)/python benchmarks/kill_soak.py --kills 50 --out out/kills
	$(BIN)/python benchmarks/aimed_kills.py --out out/aimed
	$(BIN)/python benchmarks/aimed_kills.py --ray --out out/aimed-ray
	$(BIN)/python benchmarks/store_soak.py --out out/store
	$(BIN)/python benchmarks/disk_soak.py --out out/disk

check: $(READY)  ## lint, format, types, rooms
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/basedpyright
	$(BIN)/basedpyright --project benchmarks/pyrightconfig.json --pythonpath $(BIN)/python
	$(BIN)/lint-imports
	$(BIN)/python tests/audit.py

audit: $(READY)  ## known vulnerabilities of what constraints.txt pins, where a database is reachable
	$(BIN)/python tests/audit.py

bench: $(READY)  ## every speed claim, measured against its peer in the same run
	for file in benchmarks/*.py; do $(BIN)/python $$file || exit 1; done

docs: $(READY)  ## the documentation site in out/site, to open from there; no warning passes
	PYTHONPATH=src NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet --strict
	@echo "Open out/site/index.html"

$(READY): pyproject.toml constraints.txt
	$(PYTHON) -c 'import sys; assert sys.version_info >= (3, 11), "Surmount needs Python 3.11 or newer: call make PYTHON=python3.12"'
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[dev]'
	touch $@

vega: $(READY)  ## pack the script that draws figures in pages, in the versions of the vl-convert installed
	$(BIN)/python -c 'from pathlib import Path; from surmount.report.document.vega import PACKED, bundle; Path("src/surmount/report/templates", PACKED).write_bytes(bundle())'

clean:  ## remove the environment and the demo's output
	rm -rf $(VENV) out
