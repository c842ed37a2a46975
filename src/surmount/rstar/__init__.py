"""RSTAR, the robot of the paper, and its obstacles."""
