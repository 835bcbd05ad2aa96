"""The command, run by a process that is killed in the middle of it."""

import os
import sys

from kinetix.cli import main


def run_silently(arguments: list[str]) -> None:
    """Run the command `kinetix` as a process of its own does, in silence."""
    nowhere = os.open(os.devnull, os.O_RDWR)
    for number in (1, 2):
        os.dup2(nowhere, number)
    sys.exit(main(arguments))
