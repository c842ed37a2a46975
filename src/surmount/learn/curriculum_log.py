"""What a teacher does, written to Stable-Baselines3's logger.

======================================  ======================================================
key                                     value
======================================  ======================================================
``curriculum/level``                    level just tested, from 1
``curriculum/weight/<group>``           probability of the group in what is pushed
``curriculum/success/<group>``          success of the group's episodes in the roll-out
``curriculum/rF``, ``rL``               reward over the first and the last W steps (eq. 5)
``curriculum/first_gain``               rL − rF of the level's first iteration
``curriculum/newest_gain``              rL − rF of the newest iteration
``curriculum/eq5_ratio``, ``threshold``  newest gain / first gain, and what it must fall below
``curriculum/advanced``                 1 where the level was left, 0 where it was extended
======================================  ======================================================
"""

from __future__ import annotations

from stable_baselines3.common.logger import Logger

from surmount.core.regions import Regions, success_by_region
from surmount.core.tasks import TaskDistribution
from surmount.core.teacher import LevelTest, RolloutOutcome


def log_curriculum(
    logger: Logger,
    *,
    distribution: TaskDistribution | None,
    outcome: RolloutOutcome,
    test: LevelTest | None,
    regions: Regions | None,
) -> None:
    """Record one roll-out.

    Parameters
    ----------
    logger
        Of Stable-Baselines3, with whatever outputs it has.
    distribution
        What environments draw from now; ``None`` once the teacher is finished.
    outcome
        What the roll-out brought.
    test
        The level test made on it, if one was due.
    regions
        Groups to tell apart; without, only level tests are recorded.
    """
    if regions is not None:
        rates = success_by_region(regions, outcome.episodes.variant, outcome.episodes.success)
        for name, rate in zip(regions.names, rates, strict=True):
            if rate is not None:
                logger.record(f"curriculum/success/{name}", rate)
        if distribution is not None:
            for name, share in zip(regions.names, regions.shares(distribution), strict=True):
                logger.record(f"curriculum/weight/{name}", float(share))
    if test is not None:
        logger.record("curriculum/level", test.level + 1)
        logger.record("curriculum/rF", test.first_window)
        logger.record("curriculum/rL", test.last_window)
        logger.record("curriculum/first_gain", test.first_gain)
        logger.record("curriculum/newest_gain", test.newest_gain)
        logger.record("curriculum/threshold", test.threshold)
        logger.record("curriculum/advanced", int(test.decision != "extend"))
        if test.ratio is not None:
            logger.record("curriculum/eq5_ratio", test.ratio)
