"""The protocol of the paper for any family of tasks."""
