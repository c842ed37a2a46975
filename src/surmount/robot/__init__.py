"""RSTAR: sourced constants, closed-form kinematics and the MuJoCo model built from them."""

from surmount.robot.config import RobotConfig
from surmount.robot.constants import QUANTITIES, Quantity, Source
from surmount.robot.kinematics import Gear
from surmount.robot.model import add_robot

__all__ = ["QUANTITIES", "Gear", "Quantity", "RobotConfig", "Source", "add_robot"]
