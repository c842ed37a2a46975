"""Random responses in cells, with an effect of each network."""

from __future__ import annotations

import numpy as np


def random_data(seed, n_rows=40, n_cells=4, n_subjects=5, network_sd=1.0):
    rng = np.random.default_rng(seed)
    cell = np.concatenate([np.arange(n_cells), rng.integers(0, n_cells, n_rows - n_cells)])
    subject = np.concatenate(
        [rng.integers(0, n_subjects, n_rows - n_subjects), np.arange(n_subjects)]
    )
    response = rng.normal(size=n_rows) + network_sd * rng.normal(size=n_subjects)[subject] + cell
    return response, cell, subject
