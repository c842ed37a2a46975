"""The command line, one thin file per verb."""

from surmount.cli.main import main

__all__ = ["main"]
