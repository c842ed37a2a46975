"""Gymnasium's frozen lake over its map: a category as the task.

surmount check lake_maps:make_env
surmount reproduce lake_maps:make_env --preset smoke --config lake_maps.toml --out runs/lake
"""

import gymnasium

from surmount import TaskEnv, TaskSpace

MAPS = {
    "open": ["SFFF", "FFFF", "FFFF", "FFFG"],
    "one_hole": ["SFFF", "FFFF", "FFHF", "FFFG"],
    "diagonal": ["SFFF", "FFHF", "FHFF", "FFFG"],
    "usual": ["SFFF", "FHFH", "FFFH", "HFFG"],
    "winding": ["SHFF", "FHFH", "FFFF", "HHHG"],
}


class AnyMap(gymnasium.Wrapper):
    """One lake for each map, of which the task chooses one."""

    def __init__(self):
        self.lakes = {
            name: gymnasium.make("FrozenLake-v1", desc=rows, success_rate=0.9, max_episode_steps=30)
            for name, rows in MAPS.items()
        }
        super().__init__(self.lakes["open"])

    def reset(self, *, seed=None, options=None):
        """Begin on the lake of the task."""
        self.env = self.lakes[options["task"]["map"]]
        return self.env.reset(seed=seed)


def make_env():
    return TaskEnv(
        gymnasium.wrappers.FlattenObservation(AnyMap()),  # a box, so that the map can be seen
        space=TaskSpace.grid(map=list(MAPS)),
        set_task="task",
        success=lambda transition: transition.reward > 0,
        features={
            "row": lambda transition: transition.env.s // 4,
            "column": lambda transition: transition.env.s % 4,
        },
        observe_task=True,
    )
