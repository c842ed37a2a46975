"""The page as parts, and how they are written."""
