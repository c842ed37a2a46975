"""Verdicts follow the rules: the paper's own numbers reproduce it, and others do not."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from surmount.report.evidence import Findings
from surmount.report.outcomes import Outcomes
from surmount.stats.detectable import detectable_difference
from surmount.studies.paper.claims import claims_of
from surmount.studies.paper.results import PAPER_RESULTS

TASK = "rstar/step"
STEP = PAPER_RESULTS["step"]
SIZES = np.arange(21.0, 51.0)
NETWORKS, REPETITIONS = 5, 30


def outcomes(rate, spread=0.0):
    """Return trials of five networks whose success rates lie evenly around ``rate(size)``."""
    tables = []
    for network, offset in enumerate(np.linspace(-spread, spread, NETWORKS)):
        for size in SIZES:
            won = round(float(np.clip(rate(size) + offset, 0, 1)) * REPETITIONS)
            tables.append((network, size, np.arange(REPETITIONS) < won))
    network = np.repeat([n for n, _, _ in tables], REPETITIONS)
    return Outcomes(
        parameters=("height_mm",),
        variant=np.repeat([s for _, s, _ in tables], REPETITIONS)[:, None],
        network=network,
        repetition=np.tile(np.arange(REPETITIONS), len(tables)),
        success=np.concatenate([w for _, _, w in tables]),
        end_s=np.ones(network.size),
        path_lengths={},
    )


def papers(size, kind):
    """Return the paper's rate on a size."""
    (group,) = [group for group in STEP.groups if group.holds(np.array([size]))[0]]
    if kind == "initiation":
        return group.after_initiation
    counts = getattr(group, kind)
    return 1.0 if counts is None else counts[0] / counts[1]


def results(reported_analysis, **tests):
    return Findings(analysis=reported_analysis, tests=tests, comparison=None)


def analysis(boundaries, levels=3):
    """Return an analysis of the step with groups that begin at these sizes."""
    labels = np.searchsorted(boundaries, SIZES, side="right")
    names = ("easy", "medium", "difficult", "hardest")
    return SimpleNamespace(
        variants=SIZES[:, None],
        parameters=("height_mm",),
        groups=[
            SimpleNamespace(name=names[g], variants=SIZES[labels == g][:, None])
            for g in range(labels.max() + 1)
        ],
        curriculum=SimpleNamespace(
            n_levels=levels, groups_of=lambda _: labels, success_threshold=0.95
        ),
    )


def verdicts(found):
    return {claim.claim: claim.verdict for claim in claims_of(TASK, found)}


def test_the_papers_own_numbers_reproduce_the_paper():
    tests = {
        kind: outcomes(lambda size, kind=kind: papers(size, kind), spread=0.05)
        for kind in ("initiation", "curriculum", "control")
    }
    found = verdicts(results(analysis([34, 47]), **tests))
    assert len(found) == 8
    assert set(found.values()) == {"reproduced"}


def test_arms_that_are_alike_do_not_reproduce_a_difference_but_do_reproduce_its_absence():
    same = outcomes(lambda size: 0.9)
    found = verdicts(results(analysis([34, 47]), curriculum=same, control=same))
    assert found["success with and without curriculum, easy (21–33 mm)"] == "reproduced"
    assert found["success with and without curriculum, medium (34–46 mm)"] == "not reproduced"


def test_arms_that_were_never_trained_reproduce_nothing():
    same = outcomes(lambda size: 0.97)
    found = verdicts(results(analysis([34, 47], levels=0), curriculum=same, control=same))
    assert [verdict for claim, verdict in found.items() if "with and without" in claim] == (
        ["open"] * 3
    )


def test_a_difference_that_only_trials_show_is_partly_reproduced():
    # One network of five gains everything: 900 trials are sure of it, five networks are not.
    control = outcomes(lambda size: 0.5)
    lucky = control.success | (control.network == 0)
    curriculum = replace(control, success=lucky)
    (claim,) = [
        claim
        for claim in claims_of(
            TASK, results(analysis([34, 47]), curriculum=curriculum, control=control)
        )
        if "medium" in claim.claim
    ]
    assert claim.verdict == "partly"
    assert claim.reason.startswith("The curriculum gets further")
    least = detectable_difference(np.std([0.5, 0, 0, 0, 0], ddof=1), NETWORKS).difference
    assert f"; {100 * least:.0f} would have been found" in claim.ours


@pytest.mark.parametrize(
    ("boundaries", "levels", "expected"),
    [
        ([35, 46], 3, ("reproduced", "reproduced")),  # two variants lie elsewhere
        ([36, 46], 3, ("partly", "reproduced")),  # three do
        ([47], 2, ("not reproduced", "not reproduced")),
    ],
)
def test_groups_count_as_the_same_up_to_one_variant_for_each_boundary(boundaries, levels, expected):
    found = verdicts(results(analysis(boundaries, levels)))
    assert (found["groups"], found["levels"]) == expected


def test_an_obstacle_that_the_paper_does_not_know_has_no_claims():
    assert claims_of("moat", results(analysis([34]))) == ()
