"""Studies that ran once and stay runnable."""
