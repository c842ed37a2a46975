"""RSTAR: sourced constants, closed-form kinematics and the MuJoCo model built from them."""
