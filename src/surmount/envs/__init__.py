"""Environments: the contract, families of tasks, and the registry they are found in."""
