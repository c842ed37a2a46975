"""Obstacle courses for RSTAR as Gymnasium environments, single and batched."""
