"""Settings of the frontier teacher, each with its reason."""

from __future__ import annotations

import math
from dataclasses import dataclass

from surmount.core.errors import ConfigError

_RATES = (
    "target", "floor", "mastered_bound", "fallen_by", "uniform_share", "rehearsal_share",
    "most_of_one_group", "bound_tail", "plateau_rise",
)  # fmt: skip
_COUNTS = (
    "horizon_episodes", "mastered_episodes", "plateau_episodes", "review_episodes",
    "first_successes", "first_episodes", "fast_episodes",
)  # fmt: skip
_POSITIVE = ("sharpness", "shrinkage_episodes", "switch_margin")
_NOT_NEGATIVE = ("progress_bonus", "novelty_bonus")


@dataclass(frozen=True, kw_only=True)
class FrontierConfig:
    """The frontier teacher. All values are assumed; each field says from what."""

    horizon_episodes: int = 60
    """Episodes of a group after which one counts for 1/e: its success is that of about so many. At
    our budgets a group sees some hundred episodes, so that fewer are noise, more are past."""

    shrinkage_episodes: float = 8.0
    """m: a cell's success is mixed with so many episodes of its group's. A cell has three to five
    episodes within the horizon; alone, their success has a standard error of 25 points."""

    target: float = 0.6
    """t: success at which a task is worth most; between 0.5, where success says most, and SGS's
    0.66, as failures also cost steps: a failed episode is several times as long."""

    sharpness: float = 2.0
    """κ: how fast the worth falls off beside the target; between SGS's 1 and 5, as pooled success
    is no exact number either."""

    floor: float = 0.02
    """ε: added to success and failure: what never succeeds is worth a thirtieth of the target."""

    bound_tail: float = 0.1
    """Probability below the lower and above the upper bound of a group's success (Beta)."""

    mastered_bound: float = 0.85
    """Lower bound of success from which a group counts as mastered: at least 57 of 60 succeed.
    Exploring policies hardly reach more."""

    mastered_episodes: int = 30
    """Episodes within the horizon that a group needs to count as mastered, and for its lower bound
    to be remembered as its best."""

    fallen_by: float = 0.15
    """A group has fallen where its success is so much below its best lower bound: four standard
    errors at the horizon, so that noise does not look like forgetting."""

    plateau_episodes: int = 80
    """Episodes of the main group without a rise after which its value halves, for as many episodes
    of all: others get their turn, but the group is never taken for learnt."""

    plateau_rise: float = 0.05
    """Rise of success within `plateau_episodes` below which the main group stands still, if it is
    below the target: about one standard error at the horizon. Above the target value falls by
    itself."""

    fast_episodes: int = 15
    """Length of the fast average of a group's success; the slow one has the horizon's."""

    progress_bonus: float = 1.0
    """c: how much a group's value grows with |fast − slow success|: a change of 30 points is worth
    30 %. Up or down: what is being forgotten counts as well."""

    novelty_bonus: float = 0.25
    """b: weight of the bonus of a group that was hardly tried, as of an upper confidence bound.
    After 1,000 episodes, 50 of them the group's, it is worth 0.09; a group at the target is worth
    the root of its number of cells."""

    uniform_share: float = 0.30
    """Share of tasks drawn uniformly; a quarter to a half in what works elsewhere."""

    rehearsal_share: float = 0.15
    """Share for groups that are mastered or falling: of our networks, groups at a weight of a
    twentieth were forgotten, at a tenth not. Drawn uniformly as long as there is none."""

    most_of_one_group: float = 0.6
    """Largest share of one group where there are others; the rest goes to these."""

    first_successes: int = 3
    """Successes among `first_episodes` of some group that make success worth looking at. Before
    that, one lucky success would decide what is practised, and groups are ranked by the share of
    the way that their episodes cover, where it is known."""

    first_episodes: int = 40
    """Newest episodes of a group in which `first_successes` are looked for."""

    switch_margin: float = 1.2
    """In the log another group becomes the main group only once its value is so many times the
    present one's; what is drawn follows the values themselves."""

    review_episodes: int = 20
    """Episodes of all groups between two reviews, in which groups become mastered, fallen, stand
    still, or the main one."""

    stop_when_mastered: bool = False
    """Whether training ends once all groups are mastered in two reviews in a row. In comparisons
    all teachers train equally long; without it the log says when it could have stopped."""

    def __post_init__(self) -> None:
        for names, sound, words in (
            (_RATES, lambda value: 0 < value < 1, "Give a value between 0 and 1."),
            (_COUNTS, lambda value: value >= 1, "Give at least 1."),
            (_POSITIVE, lambda value: 0 < value < math.inf, "Give a positive, finite value."),
            (_NOT_NEGATIVE, lambda value: 0 <= value < math.inf, "Give zero or more."),
        ):
            for name in names:
                if not sound(getattr(self, name)):
                    raise ConfigError(f"`{name}` is {getattr(self, name)}.", remedy=words)
        if self.uniform_share + self.rehearsal_share >= 1:
            raise ConfigError(
                "`uniform_share` and `rehearsal_share` leave nothing for the frontier.",
                remedy="Let them add up to less than 1.",
            )
