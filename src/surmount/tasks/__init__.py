"""The space of tasks, distributions over it, and curricula."""
