"""PPO through Stable-Baselines3, roll-outs and checkpoints."""
