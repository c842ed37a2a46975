"""Random actions in Gymnasium's vector environments and in the batched one.

A task distribution is pushed once and holds for every episode that follows, automatic resets
included.

    python examples/gymnasium_vector.py
"""

import gymnasium
import numpy as np

import surmount.rstar  # noqa: F401  (registers the courses)
from surmount import EnvConfig, TaskDistribution

GYM_ID = "surmount/NarrowChannel-v0"
NARROW = TaskDistribution.uniform(("width_mm",), np.array([180.0]), np.array([220.0]))


def widths(env, steps):
    """Return the width of every episode's channel, and how many episodes ended."""
    env.action_space.seed(0)
    _, infos = env.reset(seed=0)
    seen, ended = set(infos["variant"][:, 0]), 0
    for _ in range(steps):
        _, _, terminated, truncated, infos = env.step(env.action_space.sample())
        ended += int((terminated | truncated).sum())
        seen |= set(infos["variant"][:, 0])
    env.close()
    return seen, ended


def main(steps=1000, num_envs=2):
    config = EnvConfig(step_s=0.02, episode_s=2.0)
    results = {}
    for mode in ("sync", "async"):
        # Workers are started anew, not forked: other threads may run.
        options = {"context": "spawn"} if mode == "async" else {}
        env = gymnasium.make_vec(
            GYM_ID, num_envs, vectorization_mode=mode, vector_kwargs=options, config=config
        )
        env.call("set_task_distribution", NARROW)
        results[mode] = widths(env, steps)
    env = gymnasium.make_vec(
        GYM_ID, num_envs, vectorization_mode="vector_entry_point", config=config
    )
    env.set_task_distribution(NARROW)
    results["batched"] = widths(env, steps)
    for mode, (seen, ended) in results.items():
        print(
            f"{mode}: {ended} episodes ended, {len(seen)} widths from {min(seen):.1f} to "
            f"{max(seen):.1f} mm"
        )
    return results


if __name__ == "__main__":
    main()
