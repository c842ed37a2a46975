"""Configuration of the obstacle courses: each choice that the paper leaves open is a field."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal, get_args

from surmount.core.configuration import absent
from surmount.core.errors import ConfigError
from surmount.rstar.course.randomisation import RandomisationConfig
from surmount.rstar.robot import constants as c
from surmount.rstar.robot.config import RobotConfig, require_choice, require_range

StartRegion = Literal["before", "workspace"]
"""Where training episodes start: before the obstacle, or anywhere the robot fits."""

DistancePoint = Literal["body", "carriers"]
"""The point of the robot from which the reward measures the distance left."""


@dataclass(frozen=True, kw_only=True)
class CourseConfig:
    """Dimensions of the course. The obstacle's front face stands at x = 0; x points forward."""

    obstacle_length_m: float = 0.30
    """Length of the obstacle along the course in m; the step's from the simulation, for channel
    and entrance assumed equal."""
    step_width_m: float = 0.40
    """Width of the step block in m; from the simulation."""
    target_m: float = 0.32
    """Target line beyond the front face in m; from the simulation of step climbing, for channel
    and entrance assumed equal."""
    start_gap_m: float = 0.161
    """Gap between front wheels and front face at the fixed start in m; from the simulation."""
    floor_half_width_m: float = 0.25
    """Half the width of the floor in m; assumed, so narrow that no way leads around an obstacle."""
    floor_rear_m: float = 0.75
    """Floor behind the front face (where the robot starts) in m; assumed."""
    floor_front_m: float = 0.75
    """Floor beyond the front face in m; assumed."""
    fall_depth_m: float = 0.02
    """The robot has fallen once its base is this far below the floor's surface, in m; assumed."""

    def __post_init__(self) -> None:
        require_range("course.obstacle_length_m", self.obstacle_length_m, 0.05, 2.0)
        require_range("course.step_width_m", self.step_width_m, 0.1, 2.0)
        require_range("course.target_m", self.target_m, 0.05, 3.0)
        require_range("course.start_gap_m", self.start_gap_m, 0.01, 1.0)
        require_range("course.floor_half_width_m", self.floor_half_width_m, 0.16, 2.0)
        require_range("course.floor_rear_m", self.floor_rear_m, 0.4, 5.0)
        require_range("course.floor_front_m", self.floor_front_m, 0.1, 5.0)
        require_range("course.fall_depth_m", self.fall_depth_m, 0.005, 0.1)
        if self.floor_front_m < self.target_m + 0.2:
            raise ConfigError(
                f"`course.floor_front_m` is {self.floor_front_m!r}, too short for a target at "
                f"{self.target_m!r} m.",
                remedy="Let the floor reach at least 0.2 m beyond `course.target_m`.",
            )

    @property
    def fixed_start_m(self) -> float:
        """Position of the base along the course at the fixed start, in m."""
        return -(self.start_gap_m + (c.WHEELBASE_MM / 2 + c.WHEEL_RADIUS_MM) * 1e-3)


@dataclass(frozen=True, kw_only=True)
class StartConfig:
    """How training episodes begin. The paper draws position, sprawl and FBEM at random (III-C).

    A drawn start in which the robot would overlap the obstacle is drawn again.
    """

    region: StartRegion = "workspace"
    """"before" the obstacle only, or in the whole "workspace", on and behind it too; assumed."""
    rear_m: float = 0.45
    """Rearmost start of the base, before the front face, in m; assumed."""
    front_m: float = 0.25
    """Foremost start of the base, beyond the front face, in m; assumed."""
    lateral_m: float = 0.02
    """Largest lateral offset of the start in m; assumed. The robot cannot steer on its own."""
    yaw_deg: float = 0.0
    """Largest yaw at the start in degrees; assumed."""
    sprawl_min_deg: float = 0.0
    """Smallest sprawl at the start in degrees; assumed."""
    sprawl_max_deg: float = 90.0
    """Largest sprawl at the start in degrees; assumed. Beyond 90° the wheels leave the ground."""
    fbem_max_deg: float = 72.0
    """Largest FBEM angle to either side at the start in degrees; the paper's range."""

    def __post_init__(self) -> None:
        require_choice("start.region", self.region, get_args(StartRegion))
        require_range("start.rear_m", self.rear_m, 0.2, 2.0)
        require_range("start.front_m", self.front_m, 0.0, 2.0)
        require_range("start.lateral_m", self.lateral_m, 0.0, 0.1)
        require_range("start.yaw_deg", self.yaw_deg, 0.0, 45.0)
        require_range("start.sprawl_max_deg", self.sprawl_max_deg, 0.0, c.SPRAWL_MAX_DEG)
        require_range("start.sprawl_min_deg", self.sprawl_min_deg, 0.0, self.sprawl_max_deg)
        require_range("start.fbem_max_deg", self.fbem_max_deg, 0.0, c.FBEM_MAX_DEG)


@dataclass(frozen=True, kw_only=True)
class RewardConfig:
    """The paper's reward (eq. 6). Weights are printed there; the three units are assumed."""

    target: float = 5.0
    """Reward on reaching the target; the paper."""
    fall: float = -5.0
    """Reward on falling off the surface; the paper. Also given when the physics diverges."""
    tilt_limit_deg: float = 100.0
    """|yaw| or |pitch| above this, in degrees, sets K_b = 1; the paper."""
    tilt_factor: float = 2.0
    """Factor of K_b in −(1 + 2 K_b)/S_m; the paper."""
    yaw_limits_deg: tuple[float, float] = (5.0, 10.0)
    """Limits of |yaw| between the three values of K_yaw, in degrees; the paper."""
    yaw_gains: tuple[float, float, float] = (1e-4, 1e-3, 1e-2)
    """K_yaw within the first limit, within the second, and beyond; the paper."""
    speed_weight: float = 1e-8
    """Weight of |S|; the paper."""
    sprawl_weight: float = 0.005
    """Weight of the change of sprawl; assumed equal to the FBEM's, since lost in print."""
    fbem_weight: float = 0.005
    """Weight of the change of the FBEM angle; the paper."""
    distance_unit_m: float = 0.01
    """Unit of D_z in m; assumed to be cm. What was learnt does not single it out: after 300,000
    steps of 20 ms each, m had overcome 100, 92 and 19 % of easy, medium and difficult
    steps, cm 100, 96 and 31 % (ADR 21). ``docs/environments.md`` says what each unit costs a robot
    that is stuck."""
    distance_point: DistancePoint = field(default="body", metadata=absent("body"))
    """Where D_z is measured: at the base, which moves with the body ("body"), or half-way between
    the axles of both carriers, which stay with the wheels while FBEM swings the body ("carriers");
    assumed. An episode succeeds by the base in both cases."""
    angle_unit_deg: float = 5.0
    """Unit of the changes of angle in degrees; assumed, so that a degree costs 0.001 and a swing
    from start pose to any other costs less than a tenth of the target's reward."""
    speed_unit_mps: float = 0.001
    """Unit of S in m/s; assumed to be mm/s, as the paper's speed limits. Negligible in any unit."""

    def __post_init__(self) -> None:
        require_choice("reward.distance_point", self.distance_point, get_args(DistancePoint))
        require_range("reward.tilt_limit_deg", self.tilt_limit_deg, 0.0, 180.0)
        for name in ("distance_unit_m", "angle_unit_deg", "speed_unit_mps"):
            require_range(f"reward.{name}", getattr(self, name), 0.0, 1e6, open_low=True)
        for name in ("tilt_factor", "speed_weight", "sprawl_weight", "fbem_weight"):
            require_range(f"reward.{name}", getattr(self, name), 0.0, 1e6)
        require_range("reward.target", self.target, -1e6, 1e6)
        require_range("reward.fall", self.fall, -1e6, 1e6)
        for gain in self.yaw_gains:
            require_range("reward.yaw_gains", gain, 0.0, 1e6)
        low, high = self.yaw_limits_deg
        require_range("reward.yaw_limits_deg", low, 0.0, 180.0)
        require_range("reward.yaw_limits_deg", high, low, 180.0)


@dataclass(frozen=True, kw_only=True)
class EnvConfig:
    """An obstacle course: robot, course, starts, rewards and time."""

    robot: RobotConfig = field(default_factory=RobotConfig)
    """The robot's open properties: gear, friction, servos, mass, physics step."""
    course: CourseConfig = field(default_factory=CourseConfig)
    """Dimensions of the course."""
    start: StartConfig = field(default_factory=StartConfig)
    """Distribution of the starts of training episodes."""
    reward: RewardConfig = field(default_factory=RewardConfig)
    """The reward's weights and units."""
    randomisation: RandomisationConfig = field(default_factory=RandomisationConfig)
    """Randomised dynamics, sensor noise and late actions; off."""
    observe_targets: bool = field(default=False, metadata=absent(False))
    """Whether the targets of the speed, FBEM and sprawl servos are observed. They integrate the
    actions, and where the robot is blocked they run ahead of the measured angles, which a policy
    otherwise does not see; the paper's policy does not."""
    step_s: float = 0.01
    """Duration of a step in s, during which the action is re-applied at every physics step: chosen
    because success after the initiation then comes closest to the paper's table 1 (ADR 21).
    The makers' simulation decides every 5 ms."""
    episode_s: float = 20.0
    """Cap of an episode in s; the paper."""

    def __post_init__(self) -> None:
        require_range("step_s", self.step_s, 0.0005, 1.0)
        require_range("episode_s", self.episode_s, self.step_s, 3600.0)
        ratio = self.step_s / self.robot.physics_step_s
        if not math.isclose(ratio, round(ratio), rel_tol=1e-9) or round(ratio) < 1:
            raise ConfigError(
                f"`step_s` is {self.step_s!r}, which is not a multiple "
                f"of `robot.physics_step_s` = {self.robot.physics_step_s!r}.",
                remedy="Give a whole number of physics steps.",
            )

    @property
    def physics_steps_per_step(self) -> int:
        """Physics steps in a step."""
        return round(self.step_s / self.robot.physics_step_s)

    @property
    def steps_per_episode(self) -> int:
        """Steps until the cap: S_m of eq. 6."""
        return math.ceil(self.episode_s / self.step_s - 1e-9)
