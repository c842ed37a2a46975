"""Reference cases computed by R: see reference/make_reference.R."""

import json
from pathlib import Path

import pytest

SIX_DIGITS = 1e-6
"""The agreement promised. R's own numbers are good to about 1e-9 here: lmer is run to the root of
its derivative, but lmerTest differentiates numerically."""


def cases(name):
    return json.loads((Path(__file__).parent / "reference" / f"{name}.json").read_text())["cases"]


def parametrized(name):
    return pytest.mark.parametrize("case", [pytest.param(c, id=k) for k, c in cases(name).items()])


def assert_equal(found, expected, rtol=SIX_DIGITS):
    """Compare two sequences in which None stands for an undefined number."""
    found, expected = list(found), list(expected)
    assert [value is None for value in found] == [value is None for value in expected]
    # R's zeros come as 1e-17 or so; nothing compared here is meaningful below 1e-12.
    known = [value for value in found if value is not None]
    assert known == pytest.approx([v for v in expected if v is not None], rel=rtol, abs=1e-12)
