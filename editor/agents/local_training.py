"""A training on this machine that the app has begun: a process of its own, which ends with the app.

It writes a run's folder like any other training, so the Training panel shows it, and the command
line can go on with it.
"""

import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final, Protocol

from kinetix.errors import CommandError

_TAIL: Final = 4096
"""So much of the log is read for its last line, in every frame [bytes]."""
_UPDATE: Final = re.compile(r"\d+/\d+ ")
"""Begin of the line of an update that was made."""
NICENESS: Final = 5
"""It leaves the processor to the window and to what is played."""
LOG: Final = "training.log"
BUSY: Final = (
    "An agent is being trained already: stop it in the Training panel, or wait until it has ended."
)
"""Refusal while another training runs."""


class Process(Protocol):
    """The part of `subprocess.Popen` that is used."""

    def poll(self) -> int | None:
        """Return the exit status, or None while it runs."""
        ...

    def send_signal(self, sig: int, /) -> None:
        """Send a signal."""
        ...


Start = Callable[[Sequence[str], Path], Process]
"""Starts a command whose output goes to a file."""


def start_process(words: Sequence[str], log: Path) -> Process:
    """Start a command with low priority: it has it from its first instruction on.

    Where the app ends without a word, the command is asked to end: nobody would see it go on.
    """
    with log.open("wb") as output:
        return subprocess.Popen(
            _bound(_niced(words)),
            stdout=output,
            stderr=subprocess.STDOUT,
            stdin=subprocess.DEVNULL,
            start_new_session=True,
        )


def _bound(words: Sequence[str]) -> list[str]:
    """Return the command behind Linux's `setpriv`, which becomes it; elsewhere the command."""
    bind = shutil.which("setpriv") if sys.platform == "linux" else None
    return [bind, "--pdeathsig", "TERM", *words] if bind else list(words)


def _niced(words: Sequence[str]) -> list[str]:
    """Return the command behind POSIX's `nice`, which becomes it; elsewhere the command."""
    nice = shutil.which("nice") if os.name == "posix" else None
    return [nice, "-n", str(NICENESS), *words] if nice else list(words)


class LocalTraining:
    """At most one training at a time."""

    def __init__(self, start: Start | None = None) -> None:
        self._start = start or start_process
        self._process: Process | None = None
        self._log: Path | None = None
        self.run: Path | None = None
        """The run's folder."""
        self.told = ""
        """Its name in messages: that of the levels, or of the agent that learns more."""
        self.stopping = False

    @property
    def running(self) -> bool:
        """True if it trains."""
        return self._process is not None and self._process.poll() is None

    def begin(self, level: Path, run: Path, told: str) -> None:
        """Train an agent on a level.

        Args:
            level: The level's file.
            run: The run's folder.
            told: What the level is called in messages.

        Raises:
            CommandError: The folder cannot be made or written.
        """
        self._train(run, told, ("ppo", "--preset", "specialist", "--levels", str(level)))

    def go_on(self, run: Path, algorithm: str, steps: int | None) -> None:
        """Go on with a training that has stopped.

        Args:
            run: The run's folder, which knows the levels and the settings.
            algorithm: The word behind `kinetix train` that began it.
            steps: How many environment steps it shall have made in all; None: as many as before.

        Raises:
            CommandError: The command line cannot be stored in the folder.
        """
        more = () if steps is None else ("--total-timesteps", str(steps))
        self._train(run, run.name, (algorithm, *more))

    def _train(self, run: Path, told: str, options: Sequence[str]) -> None:
        words = (sys.executable, "-m", "kinetix", "train", *options, "--out", str(run))
        try:
            run.mkdir(parents=True, exist_ok=True)
            process = self._start(words, run / LOG)
        except OSError as error:
            raise CommandError(f"{run / LOG}: {error.strerror or error}") from error
        self.run, self._log, self._process = run, run / LOG, process
        self.told, self.stopping = told, False

    def stop(self) -> None:
        """End it: after its update, saved; at once where it has made none, while it compiles."""
        if self.running and self._process is not None:
            self.stopping = True
            at_once = getattr(signal, "SIGKILL", signal.SIGTERM)
            learning = any(_UPDATE.match(line) for line in self._lines())
            self._process.send_signal(signal.SIGTERM if learning else at_once)

    @property
    def words(self) -> str:
        """Last line that it printed."""
        return next((line for line in reversed(self._lines(_TAIL)) if line.strip()), "")

    def _lines(self, most: int | None = None) -> list[str]:
        """Return the lines of its log, or of its last bytes; none where it cannot be read."""
        if self._log is None:
            return []
        try:
            with self._log.open("rb") as log:
                if most is not None:
                    log.seek(max(log.seek(0, os.SEEK_END) - most, 0))
                return log.read().decode("utf-8", errors="replace").splitlines()
        except OSError:
            return []

    def ended(self) -> str | None:
        """Return, once, "" for a normal end or the error message; None while it runs.

        Stopping it is not an error.
        """
        if self._process is None or self.running:
            return None
        status, self._process = self._process.poll(), None
        if self.run is not None and not os.path.isdir(self.run):
            return "its folder is gone, and what was learnt with it."
        return "" if status == 0 or self.stopping else self.words
