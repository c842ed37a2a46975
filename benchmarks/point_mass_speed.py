"""CPU time of learning on the point mass as published: the comparison has hundreds of such runs.

    OMP_NUM_THREADS=1 python benchmarks/point_mass_speed.py [STEPS]

Uniform tasks, the learner of docs/results/teachers/plans/comparison.toml. Prints steps per second
of process time, and what 819,200 steps take so. On a busy machine compare versions by turns.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

from surmount.learn.trainer import Trainer
from surmount.studies.teachers.plan import read_plan
from surmount.teachers.uniform import UniformTeacher
from surmount.workflow.monitor import SilentMonitor

PLAN = Path(__file__).parents[1] / "docs" / "results" / "teachers" / "plans" / "comparison.toml"
WHOLE = 819_200


def main(steps: int) -> None:
    config = next(plan for plan in read_plan(PLAN) if plan.label == "suite/point-mass").config
    family = config.family
    env = family.training_env(config.env, config.learner.num_envs)
    teacher = UniformTeacher(family.space(config.env).whole_range, steps)
    trainer = Trainer(env, teacher, config.learner, seed=0)
    begun = time.process_time()
    trainer.run(SilentMonitor())
    rate = steps / (time.process_time() - begun)
    print(f"{rate:,.0f} steps/s of CPU time; {WHOLE:,} steps take {WHOLE / rate:.0f} s")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 40_960)
