"""Stages as a graph, and where they run and are kept: nothing of reinforcement learning."""
