"""Pages and figures of runs and analyses."""
