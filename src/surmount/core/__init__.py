"""Records passed between stages, errors, seeds, configuration and the artefact store."""
