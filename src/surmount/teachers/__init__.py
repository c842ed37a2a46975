"""Teachers: give task distributions to environments, take outcomes, decide when to advance."""
