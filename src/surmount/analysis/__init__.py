"""From trials to a curriculum: mixtures, Hellinger distances, clusters, groups, levels."""
