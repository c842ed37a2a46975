"""From trials to a curriculum: mixtures, distances, groups, levels, with every reason kept."""
