"""Figures, tables and the HTML page, drawn from artefacts on disk."""
