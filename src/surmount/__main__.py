"""``python -m surmount``: the command line."""

from surmount.cli.main import main

main()
