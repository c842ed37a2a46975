"""Surmount: automatic curriculum determination for reinforcement learning."""
