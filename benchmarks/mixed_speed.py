"""CPU time of a step of nine environments: all three obstacles against each alone, by turns.

    OMP_NUM_THREADS=1 python benchmarks/mixed_speed.py [ROUNDS]

Random actions, the settings of the preset `paper`; medians over rounds of 250 steps.
"""

from __future__ import annotations

import sys
import time

import numpy as np

from surmount.envs.registry import find_family
from surmount.experiment.presets import preset

NAMES = ("narrow-channel", "low-entrance", "step", "all")
STEPS, NUM_ENVS = 250, 9


def main(rounds: int) -> None:
    envs = {}
    for name in NAMES:
        config = preset(f"rstar/{name}", "paper")
        envs[name] = find_family(f"rstar/{name}").training_env(config.env, NUM_ENVS)
        envs[name].reset(seed=0)
    taken: dict[str, list[float]] = {name: [] for name in NAMES}
    rng = np.random.default_rng(0)
    for _ in range(rounds):
        actions = rng.uniform(-1, 1, (STEPS, NUM_ENVS, 3))
        for name, env in envs.items():
            begun = time.process_time()
            for action in actions:
                env.step(action)
            taken[name].append((time.process_time() - begun) / STEPS)
    medians = {name: float(np.median(times)) for name, times in taken.items()}
    alone = np.mean([medians[name] for name in NAMES[:-1]])
    for name, median in medians.items():
        print(f"{name}: {1e3 * median:.2f} ms a step")
    print(f"all / mean of the single ones: {medians['all'] / alone:.2f}")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 4)
