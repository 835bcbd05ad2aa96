"""From the words of a command line to what a command shall do."""

import os
import re
import sys
from collections.abc import Sequence
from typing import Any, Final, TypeVar, get_args

import tyro

from kinetix.command_line.options import OPTIONS
from kinetix.command_line.program import Program
from kinetix.lazy import hint

_FEWEST_COLUMNS: Final = 40
"""In fewer, tyro sets the help one letter a line; in less than some six it never ends."""

_FROM_HOME: Final = re.compile(r"(--[\w-]+=)?(~(?:[/\\].*)?)", re.DOTALL)

_Command = TypeVar("_Command")


def parse(
    command: type[_Command],
    *,
    program: str,
    description: str | None = None,
    words: Sequence[str] | None = None,
    example: str = "",
) -> _Command:
    """Read the words of a command line; ends the process after help, or a sentence on a mistake.

    Args:
        command: A dataclass, or a union of subcommands: what the words are read as.
        program: The command as people type it, for the help.
        description: First lines of the help; by default the docstring of `command`.
        words: The words after the program's; by default those of this process.
        example: A command line to copy, below the help.
    """
    words = [_as_a_shell_gives_it(word) for word in (sys.argv[1:] if words is None else words)]
    columns = os.environ.get("COLUMNS", "")
    if columns.isdecimal() and int(columns) < _FEWEST_COLUMNS:
        os.environ["COLUMNS"] = str(_FEWEST_COLUMNS)
    _check_subcommand(command, program, words)
    try:
        return tyro.cli(
            command,
            prog=Program(program),
            description=description,
            args=words,
            config=(tyro.conf.FlagCreatePairsOff,),
            registry=OPTIONS,
        )
    except SystemExit as stop:
        if example and not stop.code:
            sys.stdout.write(f"Example: {example}\n")
        first = words[:1]
        if stop.code and first and not isinstance(command, type) and first[0].isalpha():
            # Of some mistakes tyro names the help of the whole command, which has no options.
            sys.stderr.write(f"The options: {program} {first[0]} --help\n")
        raise


def _check_subcommand(command: Any, program: str, words: Sequence[str]) -> None:
    """End the process where the first word names none: tyro lists whatever resembles the rest."""
    names = [get_args(each)[1].name for each in get_args(command)]
    if names and words and not words[0].startswith("-") and words[0] not in names:
        told = hint(words[0], names, listing="there are")
        sys.stderr.write(f"{program}: {words[0]!r} is not a command; {told}\n")
        raise SystemExit(2)


def _as_a_shell_gives_it(word: str) -> str:
    """Return a word with the home folder for a leading `~`, which shells leave after `=`."""
    found = _FROM_HOME.fullmatch(word)
    return word if found is None else (found[1] or "") + os.path.expanduser(found[2])
