"""The analysis as a researcher would write it with scikit-learn and SciPy, for comparison.

One scaler for all variants, the BIC over K = 2..20 on the variant of lowest success, one
full-covariance mixture per variant, the unscented Hellinger distance for each pair (arrays over
components and sigma points, no loop but that over pairs), average linkage, and a cut into the
number of groups given.
"""

from __future__ import annotations

import numpy as np
from scipy.cluster.hierarchy import fcluster, linkage
from scipy.spatial.distance import squareform
from sklearn.mixture import GaussianMixture
from sklearn.preprocessing import StandardScaler


def sigma_points(model):
    d = model.means_.shape[1]
    kappa = max(0, 3 - d)
    steps = np.sqrt(d + kappa) * np.linalg.cholesky(model.covariances_).transpose(0, 2, 1)
    means = model.means_[:, None, :]
    points = np.concatenate([means, means + steps, means - steps], axis=1)
    shares = np.full(2 * d + 1, 0.5 / (d + kappa))
    shares[0] = kappa / (d + kappa)
    return points.reshape(-1, d), (model.weights_[:, None] * shares).ravel()


def hellinger(p, q):
    total = 0.0
    for own in (p, q):
        points, weights = sigma_points(own)
        a, b = np.exp(p.score_samples(points)), np.exp(q.score_samples(points))
        total += 0.5 * np.sum(weights * (np.sqrt(a) - np.sqrt(b)) ** 2 / (0.5 * (a + b)))
    return np.sqrt(0.5 * total)


def distance_matrix(models):
    matrix = np.zeros((len(models), len(models)))
    for i, p in enumerate(models):
        for j in range(i):
            matrix[i, j] = matrix[j, i] = hellinger(p, models[j])
    return matrix


def analyse(samples, success_rate, n_groups, seed=0, regularisation=1e-4):
    """Return groups from one array of samples per variant."""
    scaler = StandardScaler().fit(np.concatenate(samples))
    scaled = [scaler.transform(x) for x in samples]
    hardest = scaled[int(np.argmin(success_rate))]
    options = {"reg_covar": regularisation, "random_state": seed}
    curve = [GaussianMixture(k, **options).fit(hardest).bic(hardest) for k in range(2, 21)]
    n_components = 2 + int(np.argmin(curve))
    models = [GaussianMixture(n_components, **options).fit(x) for x in scaled]
    links = linkage(squareform(distance_matrix(models), checks=False), method="average")
    return fcluster(links, n_groups, criterion="maxclust"), n_components
