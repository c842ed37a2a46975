"""Logged trials: the record, the table that holds it, its reading and its check."""
