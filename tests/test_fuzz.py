"""Whatever configurations, curricula, tables and commands hold: a result or a sentence.

About a thousand cases, the same ones every time, in `make test`; ``SURMOUNT_FUZZ_CASES=100000``
and ``HYPOTHESIS_PROFILE=nightly``, which draws anew, in `make nightly`.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from surmount.analysis.configuration import AnalysisConfig
from surmount.cli.main import VERBS, run
from surmount.core.configuration import dotted_keys, from_record, override, read_overrides
from surmount.core.configuration import to_record as record_of
from surmount.core.errors import SurmountError
from surmount.core.records import read_record
from surmount.experiment.config import ExperimentConfig
from surmount.experiment.presets import preset
from surmount.experiment.running import load_config
from surmount.tasks.curriculum import Curriculum
from surmount.trials.table import read_trials, trials_from_table

CASES = int(os.environ.get("SURMOUNT_FUZZ_CASES", "1000"))


def cases(share: float):
    """Return settings for a share of all cases."""
    return settings(
        max_examples=max(1, round(share * CASES)),
        suppress_health_check=list(HealthCheck),
    )


texts = st.text(max_size=12)
numbers = (
    st.integers()
    | st.floats()
    | st.sampled_from([0, -1, 1, 1e308, -1e-320, 2**63, 10**400, float("nan"), float("inf")])
)
leaves = st.none() | st.booleans() | numbers | texts
values = st.recursive(
    leaves,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(texts, inner, max_size=4),
    max_leaves=8,
)
KEYS = dotted_keys(ExperimentConfig)
keys = st.sampled_from(KEYS) | st.sampled_from(dotted_keys(AnalysisConfig)) | texts


def result_or_sentence(function, *arguments):
    """Call something; a `SurmountError` with both its sentences is as good as a result."""
    try:
        return function(*arguments)
    except SurmountError as error:
        if error.message.strip() and error.remedy.strip():
            return None
        raise


@cases(0.2)
@given(st.dictionaries(keys, values, max_size=5))
def test_any_override_of_a_configuration_is_taken_or_refused(changes):
    result_or_sentence(override, preset("step", "smoke"), changes)
    result_or_sentence(override, AnalysisConfig(), changes)


@cases(0.15)
@given(st.dictionaries(st.sampled_from([*record_of(preset("step", "smoke"))]) | texts, values))
def test_any_record_becomes_a_configuration_or_is_refused(record):
    result_or_sentence(from_record, ExperimentConfig, record)


lines = st.lists(
    st.tuples(keys, values).map(lambda pair: f"{pair[0]} = {_toml(pair[1])}")
    | st.text(max_size=30),
    max_size=5,
).map("\n".join)


def _toml(value) -> str:
    return json.dumps(value, default=str).replace("null", '"null"')


@cases(0.1)
@given(lines.map(str.encode) | st.binary(max_size=60), st.sampled_from([".toml", ".json"]))
def test_any_configuration_file_is_read_or_refused(tmp_path_factory, content, suffix):
    path = _file(tmp_path_factory, f"c{suffix}", content)
    changes = result_or_sentence(read_overrides, path)
    if changes:
        result_or_sentence(override, preset("low-entrance", "smoke"), changes)


CURRICULUM = {
    "kind": "surmount curriculum",
    "schema": 1,
    "parameters": ["height_mm"],
    "success_threshold": 0.95,
    "groups": [
        {
            "name": name,
            "variants": [[low], [low + 5.0]],
            "success_rate": rate,
            "boxes": [{"lower": [low], "upper": [low + 5.0], "weight": 2}],
        }
        for name, low, rate in (("easy", 100.0, 1.0), ("difficult", 55.0, 0.2))
    ],
    "levels": [{"dominant": "difficult", "weights": {"easy": 0.25, "difficult": 0.75}}],
}


@st.composite
def changed(draw, record):
    """Draw a record in which some entries, anywhere, were replaced, removed or added."""
    copy = json.loads(json.dumps(record))
    for _ in range(draw(st.integers(1, 3))):
        node = copy
        while True:
            places = list(node) if isinstance(node, dict) else list(range(len(node)))
            if not places:
                break
            place = draw(st.sampled_from(places))
            inner = node[place]
            if isinstance(inner, dict | list) and inner and draw(st.booleans()):
                node = inner
                continue
            match draw(st.sampled_from(["replace", "remove", "add"])):
                case "replace":
                    node[place] = draw(values)
                case "remove":
                    del node[place]
                case "add" if isinstance(node, dict):
                    node[draw(texts)] = draw(values)
                case _:
                    node.append(draw(values))
            break
    return copy


def test_the_curriculum_that_is_changed_below_is_sound(tmp_path):
    path = tmp_path / "curriculum.json"
    path.write_text(json.dumps(CURRICULUM), encoding="utf-8")
    assert Curriculum.load(path).n_levels == 1


@cases(0.25)
@given(changed(CURRICULUM))
def test_any_curriculum_is_read_or_refused(tmp_path_factory, record):
    content = json.dumps(record, default=str).encode("utf-8", "surrogatepass")
    path = _file(tmp_path_factory, "curriculum.json", content)
    curriculum = result_or_sentence(Curriculum.load, path)
    if curriculum is not None:
        rng = np.random.default_rng(0)
        for level in range(curriculum.n_levels):
            curriculum.sample(level=level, rng=rng, size=2)
        assert Curriculum.load(path).to_record() == curriculum.to_record()


@cases(0.05)
@given(st.binary(max_size=200))
def test_any_bytes_are_a_record_or_refused(tmp_path_factory, content):
    path = _file(tmp_path_factory, "run.json", content)
    result_or_sentence(read_record, path)
    result_or_sentence(load_config, path.parent)


COLUMNS = ("variant", "variant.a", "network", "trial", "success", "time_s", "x")
columns = st.dictionaries(
    st.sampled_from(COLUMNS) | texts,
    st.lists(leaves, min_size=2, max_size=4) | st.lists(st.integers(0, 1), min_size=3, max_size=3),
    max_size=7,
)


@cases(0.15)
@given(columns)
def test_any_columns_are_trials_or_refused(table):
    result_or_sentence(trials_from_table, table)


rows = st.lists(
    st.lists(st.sampled_from([*COLUMNS, "0", "1", "-2.5", "nan", "", '"', "a;b"]) | texts).map(
        ",".join
    ),
    max_size=6,
).map("\n".join)
SOUND = "variant,network,trial,success,x\n0,0,0,1,2.5\n1,0,0,0,{}\n"


@cases(0.05)
@given(
    rows.map(str.encode) | st.binary(max_size=80) | texts.map(lambda t: SOUND.format(t).encode()),
    st.sampled_from([".csv", ".parquet", ".txt"]),
)
def test_any_table_file_is_read_or_refused(tmp_path_factory, content, suffix):
    result_or_sentence(read_trials, _file(tmp_path_factory, f"trials{suffix}", content))


OPTIONS = ("--set", "--config", "--preset", "--networks", "--processes", "--executor", "--address",
           "--retries", "--why", "--resume", "--variant", "--trial", "--at", "--help")  # fmt: skip
words = st.sampled_from(
    ["step", "low-entrance", "paper", "ray", "0", "-1", "seed=3", "networks=1e99", "x=", "=", "nan"]
) | st.text(max_size=8).filter(lambda text: "\0" not in text)
commands = st.tuples(
    st.sampled_from(["config", "reproduce", "analyze", "show", "report", "render"]) | texts,
    st.lists(st.sampled_from(OPTIONS) | words, max_size=6),
)


@pytest.fixture(scope="module")
def blocked(tmp_path_factory):
    """Return a path below a file: no command can make it a folder and begin to work."""
    file = tmp_path_factory.mktemp("cli") / "file"
    file.write_text("", encoding="utf-8")
    return file / "out"


@cases(0.05)
@given(command=commands)
def test_any_command_line_ends_with_a_code(blocked, command):
    verb, arguments = command
    written = ["--out", str(blocked)] if verb in {"reproduce", "analyze", "render"} else []
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            code = run([verb, *arguments, *written])
        except SystemExit as ended:  # of the parser: a wrong option, or help
            code = ended.code
    assert code in (0, 1, 2, 3, 4, 5, 6, 7)
    assert "Traceback" not in err.getvalue()
    if code == 0:
        assert verb in VERBS or not verb or "--help" in arguments
        assert out.getvalue()


def _file(tmp_path_factory, name: str, content: bytes) -> Path:
    folder = tmp_path_factory.getbasetemp() / "fuzz"
    folder.mkdir(exist_ok=True)
    path = folder / name
    path.write_bytes(content)
    return path
