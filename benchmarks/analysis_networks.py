"""Networks pooled into one mixture per variant, or compared one by one: which finds known groups.

    python benchmarks/analysis_networks.py [families per kind, default 20]

Two networks (or four) try every variant. *Pooled* (the paper): one mixture per variant over the
trials of all. Otherwise a mixture per variant and network, and the networks' distances D of two
variants combined: *mean*, of D² (D² of the joint distribution of network and behaviour);
*product*, 1 - D² the geometric mean of the networks' 1 - D² (from the product of their
distributions); *largest*. Families of the kinds of analysis_cut_rules.py; 8 components, the cut
rule `abrupt` at several cut-offs, small groups merged; adjusted Rand index as there.
"""

from __future__ import annotations

import sys

import numpy as np

from analysis_cut_rules import KINDS, family, scores
from surmount import AnalysisConfig, hellinger_matrix
from surmount.analysis.features import variant_samples
from surmount.analysis.fitting import FitSamples, mixture_of

CUT_OFFS = (1.4, 1.5, 1.6, 1.7, 1.8)
CONFIG = AnalysisConfig(components=8, restarts=1, max_samples=2_000)


def fitted(data, keep):
    """Return the distances of mixtures fitted to the samples whose trial is kept."""
    scaling = data.features.scaling
    return hellinger_matrix(
        [
            mixture_of(FitSamples(z[keep[trial]]).fit(8, CONFIG, 0), scaling, CONFIG, 8)
            for z, trial in zip(data.samples, data.trial, strict=True)
        ]
    )


def matrices(trials):
    """Return the distances of pooled networks, and combinations of the networks' own."""
    data = variant_samples(trials, CONFIG)
    own = np.stack(
        [fitted(data, trials.network == network) for network in np.unique(trials.network)]
    )
    return {
        "pooled": fitted(data, np.ones(trials.n_trials, dtype=bool)),
        "mean": np.sqrt(np.mean(np.square(own), axis=0)),
        "product": np.sqrt(1.0 - np.prod(1.0 - np.square(own), axis=0) ** (1.0 / len(own))),
        "largest": own.max(axis=0),
    }


def main():
    n_families = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    found = {}
    for number, kind in enumerate(KINDS):
        rng = np.random.default_rng([20_261, number])
        for _ in range(n_families):
            one = family(kind, rng)
            for name, matrix in matrices(one.generate()).items():
                found.setdefault(name, {}).setdefault(kind, []).append((one, matrix))
        print(kind, file=sys.stderr, flush=True)
    print(
        f"{n_families} families of each kind; mean adjusted Rand index of all, and of each kind.\n"
    )
    print("| distances | cut-off | all | " + " | ".join(KINDS) + " |")
    print("|---|---|---|" + "---|" * len(KINDS))
    for name, by_kind in found.items():
        for cut_off in CUT_OFFS:
            means = [scores(by_kind[kind], {"cut_off": cut_off}).mean() for kind in KINDS]
            cells = [f"{mean:.2f}" for mean in means]
            print(f"| {name} | {cut_off} | {np.mean(means):.3f} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
