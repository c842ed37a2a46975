"""Learners, roll-outs, snapshots and what is recorded of a training."""
