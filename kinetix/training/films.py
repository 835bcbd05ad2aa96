"""Films of the agent in training: an episode per level, now and then, kept with the run."""

import itertools
import os
import shutil
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final

from kinetix.agents.agent import Agent
from kinetix.agents.evaluate import NamedLevel, Settings
from kinetix.agents.films import film_episode
from kinetix.training.evaluation import levels_to_watch
from kinetix.training.progress_text import Say
from kinetix.training.setup import Setup

FILMS: Final = "films"
"""Folder of a run; a folder per number of environment steps, a GIF per level."""
MOST_LEVELS: Final = 4
"""Number of levels that are filmed, the first of those that are evaluated on."""
_PIXELS: Final = 250
_EVERY: Final = 2
"""Environment steps between two frames."""


class Filming:
    """Films an agent on the first levels that it is evaluated on."""

    def __init__(self, run: Path, setup: Setup) -> None:
        """Choose the levels.

        Args:
            run: The run's directory.
            setup: The training.

        Raises:
            KinetixError: The agent could not play one of them.
        """
        config = setup.config
        self._run = run
        self._frequency = config.video_frequency
        self._settings = Settings(seed=config.seed, physics=config.physics)
        self._levels = levels_to_watch(setup, MOST_LEVELS) if self._frequency else []

    def films_after(self, update: int, *, last: bool) -> bool:
        """Return whether the agent is to be filmed after this update."""
        due = bool(self._frequency) and (update % self._frequency == 0 or last)
        return due and bool(self._levels)

    def film(self, agent: Agent, steps: int, status: Say) -> list[Path]:
        """Film an agent.

        Args:
            agent: With its present parameters.
            steps: Environment steps it was trained for.
            status: Takes words for how far it is.

        Returns:
            The films.
        """
        folder = self._run / FILMS / str(steps)
        folder.mkdir(parents=True, exist_ok=True)
        films = []
        for number, (level, name) in enumerate(
            zip(self._levels, _file_names(self._levels), strict=True), start=1
        ):
            status(f"filming {number}/{len(self._levels)}")
            films.append(folder / f"{name}.gif")
            film_episode(films[-1], agent, level, self._settings, pixels=_PIXELS, every=_EVERY)
        return films


def stored_films(run: Path) -> Iterator[tuple[int, Path]]:
    """Yield the films of a run with the steps that they belong to, the first ones first.

    Args:
        run: The run's directory.
    """
    for steps in sorted(_steps(run)):
        for film in sorted((run / FILMS / str(steps)).glob("*.gif")):
            yield steps, film


def drop_films(run: Path, *, after: int) -> None:
    """Delete the films that will be made again.

    Args:
        run: The run's directory.
        after: Environment steps of the checkpoint that resumes.
    """
    for steps in _steps(run):
        if steps > after:
            shutil.rmtree(run / FILMS / str(steps), ignore_errors=True)


def _steps(run: Path) -> list[int]:
    folder = run / FILMS
    names = [path.name for path in folder.iterdir()] if os.path.isdir(folder) else []
    return [int(name) for name in names if name.isascii() and name.isdecimal()]


def _file_names(levels: Sequence[NamedLevel]) -> list[str]:
    """Return a file name per level, each another one, also where capitals are not told apart."""
    names: list[str] = []
    taken: set[str] = set()
    for level in levels:
        plain = "".join(sign if sign.isalnum() or sign in "-_." else "_" for sign in level.name)
        tried = itertools.chain([plain], (f"{plain}_{number}" for number in itertools.count(2)))
        names.append(next(name for name in tried if name.casefold() not in taken))
        taken.add(names[-1].casefold())
    return names
