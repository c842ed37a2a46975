import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mixed_data import random_data

from surmount.stats.mixed.inference import contrast_law, estimate, means_law
from surmount.stats.mixed.random_intercept import decompose, fit


def kenward_roger_of_the_paper(tau, s, cell, subject):
    """Φ, Φ_A, P and W exactly as Kenward and Roger (1997) print them, with full matrices."""
    x, z = np.eye(cell.max() + 1)[cell], np.eye(subject.max() + 1)[subject]
    shapes = [z @ z.T, np.eye(cell.size)]
    inverse = np.linalg.inv(tau * shapes[0] + s * shapes[1])
    phi = np.linalg.inv(x.T @ inverse @ x)
    p = [-x.T @ inverse @ g @ inverse @ x for g in shapes]
    q = [[x.T @ inverse @ g @ inverse @ h @ inverse @ x for h in shapes] for g in shapes]
    information = np.array([
        [
            np.trace(inverse @ g @ inverse @ h)
            - 2 * np.trace(phi @ q[i][j])
            + np.trace(phi @ p[i] @ phi @ p[j])
            for j, h in enumerate(shapes)
        ]
        for i, g in enumerate(shapes)
    ])  # fmt: skip
    w = 2 * np.linalg.inv(information)
    bend = sum(w[i, j] * (q[i][j] - p[i] @ phi @ p[j]) for i in range(2) for j in range(2))
    return phi, phi + 2 * phi @ bend @ phi, p, w


@given(st.integers(0, 10**6), st.sampled_from([0.0, 0.3, 3.0]))
@settings(max_examples=50)
def test_closed_forms_equal_the_matrix_formulas_of_kenward_and_roger(seed, network_sd):
    response, cell, subject = random_data(seed, network_sd=network_sd)
    found = fit(decompose(response, cell, subject))
    law = contrast_law(means_law(found, "kenward-roger"), np.eye(4))
    phi, phi_a, p, w = kenward_roger_of_the_paper(
        found.subject_variance, found.residual_variance, cell, subject
    )
    # Both sides are well conditioned here; the dense inverse costs a few digits.
    s = found.residual_variance
    assert law.covariance * s == pytest.approx(phi, rel=1e-8, abs=1e-10)
    assert law.reported * s == pytest.approx(phi_a, rel=1e-8, abs=1e-10)
    assert law.variance_covariance * s**2 == pytest.approx(w, rel=1e-8, abs=1e-10)
    for gradient, part in zip(law.gradient, p, strict=True):
        assert gradient == pytest.approx(-phi @ part @ phi, rel=1e-8, abs=1e-10)


@pytest.mark.parametrize("rule", ["kenward-roger", "satterthwaite"])
def test_a_huge_variance_between_subjects_leaves_contrasts_within_them_alone(rule):
    rng = np.random.default_rng(4)
    cell, subject = np.tile([0, 1], 20), np.repeat(np.arange(4), 10)
    noise = rng.normal(size=40) + cell
    offsets = np.array([0.0, 1.0, -2.0, 1.0])[subject]
    near, far = (
        estimate(
            means_law(fit(decompose(noise + spread * offsets, cell, subject)), rule),
            np.array([1.0, -1.0]),
            0.95,
        )
        for spread in (1e2, 1e9)
    )
    # The offsets of 1e9 are stored to 1e-7.
    assert far.value == pytest.approx(near.value, abs=1e-6)
    assert far.std_error == pytest.approx(near.std_error, rel=1e-6)
    assert far.degrees_of_freedom == pytest.approx(35, rel=1e-6)


@pytest.mark.slow
def test_intervals_of_both_rules_hold_their_level_with_few_networks():
    # Networks nested in methods: the contrast then rests on six intercepts, where the normal law
    # would cover far less than 95 % (t on 4 degrees of freedom: 1.96 covers 88 %).
    rng = np.random.default_rng(3)
    subject = np.repeat(np.arange(6), 8)
    cell = (subject >= 3).astype(np.int64)
    contrast = np.array([1.0, -1.0])
    covered = {"kenward-roger": 0, "satterthwaite": 0}
    runs = 2000
    for _ in range(runs):
        response = 2.0 * rng.normal(size=6)[subject] + rng.normal(size=48)
        found = fit(decompose(response, cell, subject))
        for rule in covered:
            interval = estimate(means_law(found, rule), contrast, 0.95)
            covered[rule] += interval.lower <= 0 <= interval.upper
    for count in covered.values():
        # Binomial standard error 0.5 %; four of them.
        assert count / runs == pytest.approx(0.95, abs=0.02)
