"""Tasks to measure teachers on: cheap, with what is known of their right groups."""
