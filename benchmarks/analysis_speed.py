"""Speed of the analysis against scikit-learn and SciPy, ratios within one run, float64.

    OMP_NUM_THREADS=2 python benchmarks/analysis_speed.py [em|sweep|matrix|growth|whole ...]

em      One iteration from the same start, 60,000 x 4 samples, K = 16.
sweep   BIC over K = 2..20 on 30,000 x 4 samples, one start each, same tolerance and regularisation.
matrix  Distances of all pairs of 1,000 mixtures, K = 16, d = 4; the pairwise loop is timed on
        some pairs and scaled up.
growth  Exponents of the time in samples, components, features and variants.
whole   30 variants x 60 trials of up to 1,000 steps, against benchmarks/plain_analysis.py.
"""

from __future__ import annotations

import resource
import sys
import time
import warnings

import numpy as np
from sklearn.exceptions import ConvergenceWarning
from sklearn.mixture import GaussianMixture

import plain_analysis
from surmount import AnalysisConfig, Mixture, determine_curriculum, hellinger_matrix
from surmount.analysis.expectation_maximisation import expand, maximise_likelihood
from surmount.analysis.fitting import Prepared, bic_curve
from surmount.analysis.starts import start_components
from surmount.analysis.synthetic import SyntheticFamily


def seconds(call, repeats=1):
    """Return the shortest time of some calls, and the last result."""
    best, result = np.inf, None
    for _ in range(repeats):
        start = time.perf_counter()
        result = call()
        best = min(best, time.perf_counter() - start)
    return best, result


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
    return seconds(lambda: maximise_likelihood(phi, start, **options), 3)[0] / (iterations + 1)


def em():
    x = samples(60_000)
    ours = iteration_seconds(x, 16)
    start = start_components(x[:4000], 16, 1e-4, np.random.default_rng(1))

    def fit(iterations):
        return GaussianMixture(
            16,
            weights_init=start.weights,
            means_init=start.means,
            precisions_init=np.linalg.inv(start.covariances),
            init_params="random",
            reg_covar=1e-4,
            max_iter=iterations,
            tol=0.0,
        ).fit(x)

    # The difference of two runs is twenty iterations without the set-up.
    theirs = (seconds(lambda: fit(25), 2)[0] - seconds(lambda: fit(5), 2)[0]) / 20
    print(f"em: {1e3 * ours:.1f} ms, scikit-learn {1e3 * theirs:.1f} ms per iteration: ", end="")
    print(f"{theirs / ours:.1f} x")


def sweep():
    x = samples(30_000)
    config = AnalysisConfig(restarts=1, max_iterations=100)
    ours, curve = seconds(lambda: bic_curve(Prepared(x), config, 0))
    theirs, values = seconds(
        lambda: [
            GaussianMixture(k, reg_covar=1e-4, random_state=0).fit(x).bic(x) for k in range(2, 21)
        ]
    )
    print(f"sweep: {ours:.2f} s, scikit-learn {theirs:.2f} s: {theirs / ours:.1f} x; smallest BIC ")
    print(f"       {min(curve.values):.0f} at K = {curve.minimum}, scikit-learn {min(values):.0f}")


def matrix():
    rng = np.random.default_rng(0)
    mixtures = [random_mixture(rng) for _ in range(1000)]
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    ours, distances = seconds(lambda: hellinger_matrix(mixtures))
    grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024
    models = []
    for mixture in mixtures[:25]:
        model = GaussianMixture(16)
        model.weights_, model.means_ = mixture.weights, mixture.means
        model.covariances_ = mixture.covariances
        precisions = np.linalg.inv(mixture.covariances)
        model.precisions_cholesky_ = np.linalg.cholesky(precisions)
        models.append(model)
    theirs, reference = seconds(lambda: plain_analysis.distance_matrix(models))
    theirs *= 999_000 / (25 * 24)
    difference = np.abs(reference - distances[:25, :25]).max()
    print(
        f"matrix: {ours:.1f} s and {grown:.0f} MiB more at the peak, pairwise loop {theirs:.0f} s"
    )
    print(f"        (from 300 pairs): {theirs / ours:.0f} x; largest difference {difference:.3f}")
    print("        (another square root of the covariances: other sigma points)")


def exponent(sizes, call):
    times = [call(size) for size in sizes]
    slope = np.polyfit(np.log(sizes), np.log(times), 1)[0]
    listed = ", ".join(f"{size}: {1e3 * t:.1f} ms" for size, t in zip(sizes, times, strict=True))
    return f"{listed}; exponent {slope:.2f}"


def growth():
    rng = np.random.default_rng(0)
    big, wide = samples(160_000), samples(20_000, 16)
    print("growth of one iteration")
    print(
        "  samples (K = 16, d = 4):",
        exponent((10_000, 40_000, 160_000), lambda n: iteration_seconds(big[:n], 16)),
    )
    print(
        "  components (20,000, d = 4):",
        exponent((4, 8, 16, 32), lambda k: iteration_seconds(big[:20_000], k)),
    )
    print(
        "  features (20,000, K = 16):",
        exponent((2, 4, 8, 16), lambda d: iteration_seconds(np.ascontiguousarray(wide[:, :d]), 16)),
    )
    mixtures = [random_mixture(rng) for _ in range(400)]
    print("growth of the distance matrix")
    print(
        "  variants (K = 16, d = 4):",
        exponent((50, 100, 200, 400), lambda n: seconds(lambda: hellinger_matrix(mixtures[:n]))[0]),
    )
    print(
        "  components (100 variants, d = 4):",
        exponent(
            (4, 8, 16, 32),
            lambda k: seconds(
                lambda: hellinger_matrix([random_mixture(rng, k) for _ in range(100)]), 2
            )[0],
        ),
    )
    print(
        "  features (100 variants, K = 16):",
        exponent(
            (2, 4, 8, 16),
            lambda d: seconds(
                lambda: hellinger_matrix([random_mixture(rng, 16, d) for _ in range(100)]), 2
            )[0],
        ),
    )


def whole():
    trials = SyntheticFamily(sizes=(13, 13, 4), separation=6.0, trials=60, steps=1000).generate()
    index = trials.sample_variant()
    tables = [trials.features[index == variant] for variant in range(30)]
    success = [trials.success[trials.variants()[1] == v].mean() for v in range(30)]
    same = AnalysisConfig(
        max_samples=0, restarts=1, plateau=0.0, bootstrap=0, sensitivity=False, max_iterations=100
    )
    ours, analysis = seconds(lambda: determine_curriculum(trials, same))
    default, _ = seconds(lambda: determine_curriculum(trials))
    theirs, (labels, n_components) = seconds(lambda: plain_analysis.analyse(tables, success, 3))
    print(
        f"whole: {trials.n_samples} samples: same work {ours:.1f} s, plain script {theirs:.1f} s,"
    )
    print(f"       {theirs / ours:.1f} x. K = {analysis.bic.chosen} and {n_components}; groups ")
    print(f"       {np.bincount(analysis.labels).tolist()} and {np.bincount(labels)[1:].tolist()}.")
    print(f"       Defaults (thinned; with bootstrap and sensitivity) {default:.1f} s.")


def main():
    warnings.simplefilter("ignore", ConvergenceWarning)
    parts = {"em": em, "sweep": sweep, "matrix": matrix, "growth": growth, "whole": whole}
    for name in sys.argv[1:] or parts:
        parts[name]()
        sys.stdout.flush()


if __name__ == "__main__":
    main()
