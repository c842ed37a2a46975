"""Pictures and films of RSTAR."""
