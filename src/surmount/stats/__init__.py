"""The paper's statistics (III-E) and intervals over networks."""
