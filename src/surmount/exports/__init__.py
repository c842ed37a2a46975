"""Curricula taken to other frameworks, and trials from elsewhere."""
