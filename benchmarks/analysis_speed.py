"""Speed of the analysis against scikit-learn and SciPy, ratios within one run, float64.

    python benchmarks/analysis_speed.py [--threads N] [--repeats N] [PART ...]

em      One iteration from the same start, 60,000 x 4 samples, K = 16.
sweep   BIC over K = 2..20 on 30,000 x 4 samples, one start each, same tolerance and regularisation.
matrix  Distances of all pairs of 1,000 mixtures, K = 16, d = 4; the pairwise loop is timed on
        some pairs and scaled up.
whole   30 variants x 60 trials of up to 1,000 steps, against benchmarks/plain_analysis.py.
growth  Exponents of the time in samples, components, features and variants.

Both sides get the same number of threads (2 by default): BLAS and OpenMP by threadpoolctl, and the
analysis by OMP_NUM_THREADS, which it reads. They take turns, and each ratio is one of medians.
"""

from __future__ import annotations

import argparse
import os
import resource
import sys
import time
import warnings
from pathlib import Path

import numpy as np
from sklearn.exceptions import ConvergenceWarning
from sklearn.mixture import GaussianMixture
from threadpoolctl import threadpool_info, threadpool_limits

import plain_analysis
from surmount import AnalysisConfig, Mixture, determine_curriculum, hellinger_matrix
from surmount.analysis.expectation_maximisation import expand, maximise_likelihood
from surmount.analysis.fitting import FitSamples, bic_curve
from surmount.analysis.initialisation import start_components

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "support"))
from synthetic_trials import SyntheticFamily


def seconds(call):
    """Return the time of a call, and its result."""
    start = time.perf_counter()
    result = call()
    return time.perf_counter() - start, result


def in_turns(repeats, *calls):
    """Time calls in turns, and return the median of each; each returns its own time."""
    return np.median([[call() for call in calls] for _ in range(repeats)], axis=0)


def random_mixture(rng, n_components=16, d=4):
    factors = 0.5 * rng.standard_normal((n_components, d, d))
    return Mixture(
        weights=rng.dirichlet(np.full(n_components, 3.0)),
        means=rng.standard_normal((n_components, d)),
        covariances=factors @ factors.transpose(0, 2, 1) + 0.1 * np.eye(d),
    )


def samples(n, d=4, seed=0):
    rng = np.random.default_rng(seed)
    x = random_mixture(rng, 16, d).sample(rng, n)
    return (x - x.mean(axis=0)) / x.std(axis=0)


def iteration_seconds(x, n_components, iterations=20):
    phi = expand(x)
    start = start_components(x[:4000], n_components, 1e-4, np.random.default_rng(1))
    options = {"regularisation": 1e-4, "tolerance": 1e-300, "max_iterations": iterations}
    return seconds(lambda: maximise_likelihood(phi, start, **options))[0] / (iterations + 1)


def em(repeats):
    x = samples(60_000)
    start = start_components(x[:4000], 16, 1e-4, np.random.default_rng(1))

    def fit_seconds(iterations):
        model = GaussianMixture(
            16,
            weights_init=start.weights,
            means_init=start.means,
            precisions_init=np.linalg.inv(start.covariances),
            init_params="random",
            reg_covar=1e-4,
            max_iter=iterations,
            tol=0.0,
        )
        return seconds(lambda: model.fit(x))[0]

    def theirs():  # the difference of two runs is iterations without the set-up
        return (fit_seconds(15) - fit_seconds(5)) / 10

    ours, other = in_turns(5 * repeats, lambda: iteration_seconds(x, 16), theirs)
    print(f"em: {1e3 * ours:.1f} ms, scikit-learn {1e3 * other:.1f} ms per iteration: ", end="")
    print(f"{other / ours:.1f} x")


def sweep(repeats):
    x = samples(30_000)
    config = AnalysisConfig(restarts=1, max_iterations=100)
    lowest = {}

    def ours():
        time_s, curve = seconds(lambda: bic_curve(FitSamples(x), config, 0))
        lowest["ours"] = (min(curve.values), curve.minimum)
        return time_s

    def theirs():
        models = [GaussianMixture(k, reg_covar=1e-4, random_state=0) for k in range(2, 21)]
        time_s, values = seconds(lambda: [model.fit(x).bic(x) for model in models])
        lowest["theirs"] = (min(values), 2 + int(np.argmin(values)))
        return time_s

    own, other = in_turns(repeats, ours, theirs)
    print(f"sweep: {own:.2f} s, scikit-learn {other:.2f} s: {other / own:.1f} x; smallest BIC")
    print(
        "       {:.0f} at K = {}, scikit-learn {:.0f} at {}".format(
            *lowest["ours"], *lowest["theirs"]
        )
    )


def matrix(repeats):
    rng = np.random.default_rng(0)
    mixtures = [random_mixture(rng) for _ in range(1000)]
    models = []
    for mixture in mixtures[:25]:
        model = GaussianMixture(16)
        model.weights_, model.means_ = mixture.weights, mixture.means
        model.covariances_ = mixture.covariances
        precisions = np.linalg.inv(mixture.covariances)
        model.precisions_cholesky_ = np.linalg.cholesky(precisions)
        models.append(model)
    found = {}

    def ours():
        time_s, found["ours"] = seconds(lambda: hellinger_matrix(mixtures))
        return time_s

    def theirs():
        time_s, found["theirs"] = seconds(lambda: plain_analysis.distance_matrix(models))
        return time_s * 499_500 / 300

    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    ours()
    grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024
    own, other = in_turns(repeats, ours, theirs)
    difference = np.abs(found["theirs"] - found["ours"][:25, :25]).max()
    print(f"matrix: {own:.1f} s and {grown:.0f} MiB more at the peak, pairwise loop {other:.0f} s")
    print(f"        (from 300 pairs): {other / own:.0f} x; largest difference {difference:.3f}")
    print("        (another square root of the covariances: other sigma points)")


def whole(repeats):
    trials = SyntheticFamily(sizes=(13, 13, 4), separation=6.0, trials=60, steps=1000).generate()
    index = trials.sample_variant()
    tables = [trials.features[index == variant] for variant in range(30)]
    success = [trials.success[trials.variants()[1] == v].mean() for v in range(30)]
    same = AnalysisConfig(
        max_samples=0, restarts=1, plateau=0.0, bootstrap=0, sensitivity=False, max_iterations=100
    )
    found = {}

    def ours():
        time_s, found["ours"] = seconds(lambda: determine_curriculum(trials, same))
        return time_s

    def defaults():
        return seconds(lambda: determine_curriculum(trials))[0]

    def theirs():
        time_s, found["theirs"] = seconds(lambda: plain_analysis.analyse(tables, success, 3))
        return time_s

    own, usual, other = in_turns(repeats, ours, defaults, theirs)
    analysis, (labels, n_components) = found["ours"], found["theirs"]
    print(f"whole: {trials.n_samples} samples: same work {own:.1f} s, plain script {other:.1f} s,")
    print(f"       {other / own:.1f} x. K = {analysis.bic.chosen} and {n_components}; groups ")
    print(f"       {np.bincount(analysis.labels).tolist()} and {np.bincount(labels)[1:].tolist()}.")
    print(f"       Defaults (thinned; with bootstrap and sensitivity) {usual:.1f} s, ", end="")
    print(f"{other / usual:.1f} x.")


def growth(repeats):
    rng = np.random.default_rng(0)
    big, wide = samples(160_000), samples(20_000, 16)

    def distances(n_mixtures, n_components=16, d=4):
        mixtures = [random_mixture(rng, n_components, d) for _ in range(n_mixtures)]
        return lambda: seconds(lambda: hellinger_matrix(mixtures))[0]

    print("growth of one iteration")
    show("samples (K = 16, d = 4)", repeats, (10_000, 40_000, 160_000), lambda n: (big[:n], 16))
    show("components (20,000, d = 4)", repeats, (4, 8, 16, 32), lambda k: (big[:20_000], k))
    show(
        "features (20,000, K = 16)",
        repeats,
        (2, 4, 8, 16),
        lambda d: (np.ascontiguousarray(wide[:, :d]), 16),
    )
    print("growth of the distance matrix")
    exponent("variants (K = 16, d = 4)", repeats, (50, 100, 200, 400), distances)
    exponent(
        "components (100 variants, d = 4)", repeats, (4, 8, 16, 32), lambda k: distances(100, k)
    )
    exponent(
        "features (100 variants, K = 16)", repeats, (2, 4, 8, 16), lambda d: distances(100, 16, d)
    )


def show(what, repeats, sizes, arguments):
    def timed(size):
        x, n_components = arguments(size)
        return lambda: iteration_seconds(x, n_components)

    exponent(what, repeats, sizes, timed)


def exponent(what, repeats, sizes, timed):
    """Print the exponent of a power law through the times of sizes, which take turns."""
    times = in_turns(3 * repeats, *[timed(size) for size in sizes])
    slope = np.polyfit(np.log(sizes), np.log(times), 1)[0]
    listed = ", ".join(f"{size}: {1e3 * t:.1f} ms" for size, t in zip(sizes, times, strict=True))
    print(f"  {what}: {listed}; exponent {slope:.2f}")


PARTS = {"em": em, "sweep": sweep, "matrix": matrix, "whole": whole, "growth": growth}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--repeats", type=int, default=1)
    parser.add_argument("parts", nargs="*", default=list(PARTS))
    options = parser.parse_args()
    warnings.simplefilter("ignore", ConvergenceWarning)
    os.environ["OMP_NUM_THREADS"] = str(options.threads)
    with threadpool_limits(options.threads):
        counts = {f"{pool['internal_api']} {pool['num_threads']}" for pool in threadpool_info()}
        load = ", ".join(f"{value:.1f}" for value in os.getloadavg())
        print(f"{options.threads} threads ({', '.join(sorted(counts))}); load before {load}")
        for name in options.parts:
            PARTS[name](options.repeats)
            sys.stdout.flush()


if __name__ == "__main__":
    main()
