"""A curriculum for the lunar lander in a plain Stable-Baselines3 script: a wrapper and a callback.

surmount analyze trials.parquet --out results
python examples/own_environment_sb3.py results/curriculum.json
"""

import sys

from stable_baselines3 import PPO
from stable_baselines3.common.env_util import make_vec_env

import lunar_lander
from surmount import AdvancementConfig, Curriculum, LevelTeacher, Regions, TeacherCallback


def lengths_within(steps, n_levels):
    """Return lengths in which all levels have room; extensions a fifth of k, as in the paper."""
    unit = steps // (30 * n_levels)  # a level lasts 30 at most: 10, and ten extensions of 2
    return AdvancementConfig(
        iteration_steps=10 * unit, extension_steps=2 * unit, window_steps=unit, max_extensions=10
    )


def main(path, steps=500_000, num_envs=4, log="runs/sb3", rollout=1024):
    curriculum = Curriculum.load(path)
    levels = [curriculum.level_distribution(level) for level in range(curriculum.n_levels)]
    callback = TeacherCallback(
        LevelTeacher(levels, lengths_within(steps, len(levels))),
        regions=Regions.of(curriculum),
        verbose=1,
    )
    env = make_vec_env(lunar_lander.make_env, num_envs, seed=0)
    model = PPO("MlpPolicy", env, n_steps=rollout, tensorboard_log=log, seed=0)
    model.learn(steps, callback=callback)
    callback.save(f"{log}/teacher.json")
    env.close()
    return callback


if __name__ == "__main__":
    main(sys.argv[1])
