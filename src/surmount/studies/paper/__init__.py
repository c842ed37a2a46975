"""What the paper reports, to compare with."""
