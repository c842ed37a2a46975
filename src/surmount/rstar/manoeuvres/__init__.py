"""Scripted manoeuvres and their search."""
