"""The command `kinetix`: one module per sub-command, imported only when it is asked for.

The module `kinetix.cli.NAME` has a frozen dataclass `Name` that describes the arguments (or a union
of such, for commands of a second level) and `run(command) -> int`, which returns the exit status.
"""

import difflib
import gc
import importlib
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import Any, Final

from kinetix.bounds import LAST_SEED
from kinetix.cli.shared.one_core import OneCore
from kinetix.cores import check_cores, use_all_cores
from kinetix.errors import KinetixError
from kinetix.failures import (
    INTERRUPTED,
    TERMINATED,
    guarded,
    interrupts_later,
    leave,
    plain_streams,
)
from kinetix.files.caches import tidy_caches
from kinetix.files.compiled import mended_programs
from kinetix.paths import cache_dir

COMMANDS: Final[dict[str, str]] = {
    "validate": "list the problems of levels and level sets",
    "convert": "turn levels from one file format into the other",
    "render": "draw a level as a picture or a film",
    "play": "play one episode without a window",
    "solve": "search for actions that win a level",
    "sample": "make random levels",
    "eval": "measure an agent on levels",
    "compare": "measure several agents on the same levels and seeds",
    "levelset": "build, check and split level sets",
    "dataset": "record episodes of people, agents and the search as data",
    "train": "train an agent",
    "teach": "make a data set of wins on random levels, to learn from",
    "bench": "measure speed, scaling, accuracy and rendering",
    "cache": "say how much compiled programs and thumbnails take, or clear them",
}
"""Every sub-command and what it does."""

_MEASURES_COMPILING: Final = "bench"
_CACHE: Final = "JAX_COMPILATION_CACHE_DIR"
_SELDOM: Final = (100_000, 50, 100)
"""Thresholds of the garbage collector: tracing makes many objects and next to no garbage.

With Python's own (700, 10, 10) a quarter of the time that tracing takes goes into collections.
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one sub-command.

    Args:
        arguments: The command line without the program's name; by default the process's own.

    Returns:
        The exit status: 0 done, 1 the input or the result is bad, 2 wrong usage; 130 after Ctrl+C,
        143 after SIGTERM, 141 where nobody reads what is printed any more. After a signal the
        process's own command line does not return: the process ends.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    status = guarded(lambda: _main(words), name="kinetix", words=words)
    if arguments is None and status in (INTERRUPTED, TERMINATED) and not _has_fellows():
        leave(status)
    return status


def _has_fellows() -> bool:
    """Return whether other processes of the same training wait for this one to end."""
    jax = sys.modules.get("jax")
    return jax is not None and jax.distributed.is_initialized()


def _main(words: Sequence[str]) -> int:
    while words[:1] == ["help"]:
        words = [*words[1:], "--help"]
    if not words or words[0] in ("-h", "--help"):
        print(_overview(), file=sys.stdout if words else sys.stderr)
        return 0 if words else 2
    if words[0] in ("--version", "version"):
        print(_version())
        return 0
    if words[0] not in COMMANDS:
        print(_unknown(words[0]), file=sys.stderr)
        return 2
    return _run(words[0], words[1:])


def _run(name: str, words: Sequence[str]) -> int:
    gc.set_threshold(*_SELDOM)
    if name != _MEASURES_COMPILING or words[:1] in (["accuracy"], ["everyday"]):
        # A second run of the same size compiles nothing; JAX reads this when it is imported.
        if _CACHE not in os.environ and _can_be_filled(compiled := cache_dir() / "jax"):
            os.environ[_CACHE] = str(compiled)
        # XLA calls its own tuning hints unknown processor features when it reads that cache.
        os.environ.setdefault("TF_CPP_MIN_LOG_LEVEL", "3")
    try:
        with interrupts_later():
            module = importlib.import_module(f"kinetix.cli.{name}")
        command = _parse(module, name, words)
    except SystemExit as stop:  # the parser's way out: 0 after --help, 2 after a usage error
        return stop.code if isinstance(stop.code, int) else 2
    _check_seed(name, command)
    with plain_streams(), mended_programs():
        if isinstance(command, OneCore):
            check_cores(command.cores)
        elif hasattr(command, "cores"):
            with interrupts_later():  # JAX is imported here
                use_all_cores(command.cores, unless_started=command.cores is None)
        status = module.run(command)
    if "jax" in sys.modules:  # it may have written to its cache
        tidy_caches()
    return status


def _check_seed(name: str, command: Any) -> None:
    """Refuse what JAX's generator cannot be seeded with; levels and sets are drawn by Python's."""
    seed = getattr(command, "seed", None)
    if name not in ("sample", "levelset") and isinstance(seed, int) and not 0 <= seed <= LAST_SEED:
        raise KinetixError(f"--seed {seed}: expected a whole number from 0 to {LAST_SEED}")


def _can_be_filled(folder: Path) -> bool:
    """Make a folder; JAX warns about each program where it cannot keep them."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    return os.access(folder, os.W_OK)


def _parse(module: ModuleType, name: str, words: Sequence[str]) -> Any:
    from kinetix.cli.shared.examples import example_of
    from kinetix.command_line.parse import parse  # here: the overview stays instant

    return parse(
        getattr(module, name.capitalize()),
        program=f"kinetix {name}",
        description=module.__doc__,
        words=words,
        example=example_of(name, words),
    )


def _overview() -> str:
    width = max(map(len, COMMANDS))
    lines = [f"  {name:{width}}  {does}" for name, does in COMMANDS.items()]
    return "\n".join(
        [
            "usage: kinetix COMMAND [ARGUMENTS]",
            "",
            *lines,
            "",
            "`kinetix help COMMAND` tells the arguments; `kinetix-editor` opens the editor.",
        ]
    )


def _unknown(word: str) -> str:
    near = difflib.get_close_matches(word, COMMANDS, n=1)
    hint = f"did you mean {near[0]!r}?" if near else f"there are {', '.join(COMMANDS)}."
    return f"kinetix: {word!r} is not a command; {hint}"


def _version() -> str:
    from kinetix.version import __version__

    return __version__
