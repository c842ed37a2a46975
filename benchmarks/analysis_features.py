"""Grouping of RSTAR trials by other features than the paper's four, and how far to trust it.

    surmount reproduce step --preset smoke --out DIR
    python benchmarks/analysis_features.py DIR [all | 0 | 1 ...]

Reads the trials of a run after its initiation (stages/trials), of all networks together and of each
by itself. For each set of features: mixtures with as many components as the paper's features
got by the BIC, distances, and groups. "Distances" is the rank correlation with the distances by
the paper's features, which no cut touches; "index" is the adjusted Rand index with their grouping,
under the default cut and under the dendrogram's two and three highest branches (which, unlike the
default, always divide). The row of another seed shows what the chance of the starts alone does.
"""

from __future__ import annotations

import dataclasses
import sys
from pathlib import Path

import numpy as np
from scipy.stats import spearmanr

from surmount import AnalysisConfig, Trials, determine_curriculum, read_trials
from surmount.analysis.agreement import adjusted_rand
from surmount.analysis.description import describe_variants
from surmount.analysis.sensitivity import group_variants

PAPER = ("time_s", "sprawl_deg", "fbem_deg", "distance_m")
SETS = {
    "the paper's four": {},
    "the same, another seed": {"seed": 1},
    "PCA, 99 % of the variance": {"reduction": "pca", "explained_variance": 0.99},
    "PCA, 95 %": {"reduction": "pca", "explained_variance": 0.95},
    "PCA, 90 %": {"reduction": "pca", "explained_variance": 0.90},
    "PCA, 70 %": {"reduction": "pca", "explained_variance": 0.70},
    **{
        f"without {name}": {"features": tuple(other for other in PAPER if other != name)}
        for name in PAPER
    },
    "time and distance": {"features": ("time_s", "distance_m")},
    "sprawl and FBEM": {"features": ("sprawl_deg", "fbem_deg")},
}


def groups_text(analysis):
    return "; ".join(describe_variants(group.variants) for group in analysis.groups)


def forced(analysis, count):
    config = dataclasses.replace(analysis.config, cut="fixed count", group_count=count)
    return group_variants(analysis.distances, config)


def compare(trials):
    base = AnalysisConfig(features=PAPER, max_components=12)
    first = determine_curriculum(trials, base)
    count = max(mixture.n_components for mixture in first.mixtures)
    pairs = np.triu_indices(len(first.mixtures), 1)
    print(f"\n{trials.n_trials} trials, {trials.n_samples} control steps, K = {count}.\n")
    print(
        "| features | dimensions | distances | groups | index | index of 2 | of 3 | same number |"
    )
    print("|---|---|---|---|---|---|---|---|")
    for name, options in SETS.items():
        config = dataclasses.replace(base, components=count, sensitivity=False, **options)
        found = determine_curriculum(trials, config)
        rank = spearmanr(found.distances[pairs], first.distances[pairs])[0]
        cells = [
            name,
            str(len(found.features.names)),
            f"{rank:.2f}",
            groups_text(found),
            f"{adjusted_rand(found.labels, first.labels):.2f}",
            *(f"{adjusted_rand(forced(found, n), forced(first, n)):.2f}" for n in (2, 3)),
            f"{found.stability.same_count:.0%}",
        ]
        print("| " + " | ".join(cells) + " |", flush=True)
    print("\nOne choice changed at a time (the paper's features):\n")
    print("| choice | changed to | groups | index |")
    print("|---|---|---|---|")
    for row in first.sensitivity:
        print(f"| {row.choice} | {row.value} | {row.n_groups} | {row.agreement:.2f} |")
    shares = ", ".join(f"{n} in {share:.0%}" for n, share in first.stability.group_counts)
    print(f"\nBootstrap: groups {shares}; pairs as here {first.stability.agreement:.0%}.")
    for index in np.flatnonzero(first.stability.boundaries > 0.2):
        low, high = first.variants[index : index + 2, 0]
        print(f"- between {low:g} and {high:g}: {first.stability.boundaries[index]:.0%}")
    print("\nSuccess: " + ", ".join(f"{rate:.0%}" for rate in first.success_rate))


def main():
    paths = sorted((Path(sys.argv[1]) / "stages" / "trials").glob("*/*/trials.parquet"))
    networks = [read_trials(path) for path in paths]
    sets = {"all": networks, **{str(number): [part] for number, part in enumerate(networks)}}
    for name in sys.argv[2:] or sets:
        print(
            f"\n## {'All networks' if name == 'all' else f'Network {name} by itself'}", flush=True
        )
        compare(Trials.concatenate(sets[name]))


if __name__ == "__main__":
    main()
