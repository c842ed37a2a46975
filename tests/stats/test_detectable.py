import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.special import ndtr, stdtrit
from scipy.stats import chi, ttest_1samp

from surmount.core.errors import InputError
from surmount.stats.detectable import detectable_difference, networks_needed, paired_power

sds = st.floats(0.01, 100)
numbers_of_networks = st.integers(2, 60)


def power_by_quadrature(difference, sd, n_networks, level):
    """Power of the paired t-test, summed over what the estimate of the spread may turn out to be.

    Given s/σ the mean of the differences is normal, so no noncentral law is needed.
    """
    df, shift = n_networks - 1, difference / sd * np.sqrt(n_networks)
    critical, root = stdtrit(df, 1 - level / 2), np.sqrt(df)

    def share(ratio):
        return ndtr(shift - critical * ratio) * chi.pdf(ratio * root, df) * root

    return quad(share, 0, np.inf, epsabs=1e-12, epsrel=1e-12, limit=200)[0]


def test_power_equals_the_worked_example_of_g_power():
    # G*Power 3.1's manual, two dependent means: d_z = 0.421637 with 50 pairs.
    assert paired_power(0.421637, 1.0, 50) == pytest.approx(0.832114, abs=1e-6)


@pytest.mark.parametrize(("effect", "published"), [(0.2, 199), (0.5, 34), (0.8, 15)])
def test_cohens_small_medium_and_large_effects_need_the_published_number_of_pairs(
    effect, published
):
    assert networks_needed(effect, 1.0).n_networks == published


@pytest.mark.parametrize("power", [0.5, 0.8, 0.95])
@pytest.mark.parametrize("n_networks", [2, 3, 5, 8, 10, 40])
def test_detectable_difference_has_its_power_by_quadrature(n_networks, power):
    found = detectable_difference(40.0, n_networks, power=power)
    by_quadrature = power_by_quadrature(found.difference, 40.0, n_networks, 0.05)
    # The quadrature is asked for 1e-12 and integrates a density with its peak far from 0.
    assert by_quadrature == pytest.approx(power, abs=1e-9)


def test_eight_networks_whose_differences_vary_by_40_detect_46():
    assert detectable_difference(40.0, 8).difference == pytest.approx(46.24, abs=0.005)


@given(sds, numbers_of_networks, st.floats(0.1, 0.99))
def test_as_many_networks_are_needed_as_detect_the_difference(sd, n_networks, power):
    difference = detectable_difference(sd, n_networks, power=power).difference
    # A ten-thousandth to either side, far beyond the root's rounding.
    assert networks_needed(difference * 1.0001, sd, power=power).n_networks == n_networks
    assert networks_needed(difference * 0.9999, sd, power=power).n_networks == n_networks + 1


@given(sds, numbers_of_networks)
def test_the_detectable_difference_grows_with_the_spread_and_falls_with_networks(sd, n_networks):
    one = detectable_difference(sd, n_networks).difference
    assert detectable_difference(3 * sd, n_networks).difference == pytest.approx(3 * one, rel=1e-9)
    assert detectable_difference(sd, n_networks + 1).difference < one


def test_a_sign_does_not_matter_and_a_difference_beyond_doubt_has_power_1():
    assert paired_power(-0.4, 1.0, 9) == paired_power(0.4, 1.0, 9)
    # 40 standard errors: the noncentral law's series fails there.
    assert [paired_power(d, 1.0, 10) for d in (12.65, 1e3, 1e6)] == [1.0, 1.0, 1.0]
    assert networks_needed(-1e3, 1.0).n_networks == 2


@pytest.mark.parametrize(
    ("found", "field", "says"),
    [
        (detectable_difference(0.3, 1), "difference", "fewer than two pairs"),
        (detectable_difference(0.0, 5), "difference", "differ by the same amount"),
        (networks_needed(0.1, 0.0), "n_networks", "differ by the same amount"),
        (networks_needed(1e-5, 1.0), "n_networks", "More than 1,000,000 pairs"),
    ],
)
def test_where_nothing_can_be_said_there_is_a_reason(found, field, says):
    assert getattr(found, field) is None
    assert says in found.reason
    json.dumps(found.to_record(), allow_nan=False)


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: detectable_difference(-1.0, 5), "standard deviation is -1"),
        (lambda: detectable_difference(float("nan"), 5), "standard deviation is nan"),
        (lambda: detectable_difference(1.0, 5, level=5), "level of the test is 5"),
        (lambda: detectable_difference(1.0, 5, power=80), "power of 80"),
        (lambda: detectable_difference(1.0, 5, power=0.01), "power of 0.01"),
        (lambda: networks_needed(0.0, 1.0), "a difference of 0"),
        (lambda: paired_power(0.1, 0.0, 5), "no t-test of 5 pairs"),
        (lambda: paired_power(0.1, 1.0, 1), "no t-test of 1 pairs"),
    ],
)
def test_bad_numbers_are_named(call, says):
    with pytest.raises(InputError, match=says):
        call()


@pytest.mark.slow
def test_the_detectable_difference_is_found_in_four_of_five_simulated_experiments():
    rng = np.random.default_rng(11)
    for n_networks in (3, 8):
        true = detectable_difference(40.0, n_networks).difference
        test = ttest_1samp(rng.normal(true, 40.0, (100_000, n_networks)), 0.0, axis=1)
        found = ((test.pvalue < 0.05) & (test.statistic > 0)).mean()
        assert found == pytest.approx(0.8, abs=0.004)  # three binomial standard errors
