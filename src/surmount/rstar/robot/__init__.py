"""RSTAR: sourced constants, closed-form kinematics and the MuJoCo model built from them."""

from surmount.rstar.robot.config import RobotConfig
from surmount.rstar.robot.constants import QUANTITIES, Quantity, Source
from surmount.rstar.robot.kinematics import Gear
from surmount.rstar.robot.model import add_robot

__all__ = ["QUANTITIES", "Gear", "Quantity", "RobotConfig", "Source", "add_robot"]
