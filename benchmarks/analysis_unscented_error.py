"""Error of the unscented Hellinger distance over random mixtures, from far to overlapping.

    python benchmarks/analysis_unscented_error.py [d ...]

Pairs of mixtures of 1, 4 and 16 components in 1 to 8 dimensions; q is p with its means moved by
a shift of the given length (in units of a component's standard deviation) and its covariances
redrawn. The reference is randomised quasi-Monte Carlo with a standard error of D² below 1e-3.
"""

from __future__ import annotations

import sys

import numpy as np

from surmount.analysis.mixture import Mixture
from surmount.analysis.reference import check_hellinger

SHIFTS = (0.0, 0.5, 1.0, 2.0, 4.0, 8.0)
PAIRS = 6


def random_mixture(rng, n_components, d, means):
    factors = rng.standard_normal((n_components, d, d)) * 0.4
    covariances = factors @ factors.transpose(0, 2, 1) + 0.5 * np.eye(d)
    weights = rng.dirichlet(np.full(n_components, 3.0))
    return Mixture(weights=weights, means=means, covariances=covariances)


def main():
    print("| d | K | " + " | ".join(f"shift {shift:g}" for shift in SHIFTS) + " |")
    print("|---|---|" + "---|" * len(SHIFTS))
    for d in map(int, sys.argv[1:] or range(1, 9)):
        for n_components in (1, 4, 16):
            cells = []
            for shift in SHIFTS:
                checks = []
                for pair in range(PAIRS):
                    rng = np.random.default_rng([d, n_components, int(10 * shift), pair])
                    means = 2.0 * rng.standard_normal((n_components, d))
                    step = rng.standard_normal((n_components, d))
                    step *= shift / np.linalg.norm(step, axis=1, keepdims=True)
                    p = random_mixture(rng, n_components, d, means)
                    q = random_mixture(rng, n_components, d, means + step)
                    checks.append(check_hellinger(p, q, seed=pair))
                mean = np.mean([check.reference for check in checks])
                errors = np.asarray([check.error for check in checks])
                worst = errors[np.abs(errors).argmax()]
                cells.append(f"{mean:.2f}: {errors.mean():+.3f} ({worst:+.3f})")
            print(f"| {d} | {n_components} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
