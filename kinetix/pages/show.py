"""Runs and episodes shown in notebooks: the page in a frame."""

import dataclasses
import html
import os
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from kinetix.errors import KinetixError, LevelError
from kinetix.files.atomic import write_atomically
from kinetix.level.codec import load_level
from kinetix.level.model import Level
from kinetix.pages.film import Film
from kinetix.pages.page import MOST_FILMS, page_of
from kinetix.pages.recorded import film_of_file

if TYPE_CHECKING:
    from kinetix.environment.simulation import Run

HEIGHT: Final = 760
"""Of the frame in a notebook [px]."""


@dataclasses.dataclass(frozen=True, kw_only=True, repr=False)
class Page:
    """A page; notebooks show it, `save` writes it."""

    html: str
    """The whole document."""

    def save(self, path: str | Path) -> None:
        """Write the page to a file.

        Raises:
            LevelError: The file cannot be written.
        """
        write_atomically(Path(path), self.html.encode())

    def _repr_html_(self) -> str:
        framed = html.escape(self.html, quote=True)
        return (
            f'<iframe srcdoc="{framed}" style="width:100%;height:{HEIGHT}px;border:0" '
            'sandbox="allow-scripts"></iframe>'
        )

    def __repr__(self) -> str:
        return f"Page({len(self.html.encode()) // 1000} kB)"


def show(*shown: Any) -> Page:
    """Return a page that plays a run of `kinetix.simulate` or an episode; notebooks show it.

    Args:
        *shown: A run, the path of an episode that the editor recorded (`.npz`), a film, or a level,
            its file or the name of a bundled one; or two of the same level, to be played side by
            side.

    Raises:
        KinetixError: An argument is something else, or they are of different levels.
    """
    if not 1 <= len(shown) <= MOST_FILMS:
        raise KinetixError(f"show: expected one run, or two side by side, got {len(shown)}")
    try:
        return Page(html=page_of([_film(one) for one in shown]))
    except ValueError as error:
        raise KinetixError(str(error)) from None


def film_of_run(run: "Run") -> Film:
    """Return the film of a simulated level.

    Args:
        run: From `kinetix.simulate`.
    """
    return Film(
        level=run.level,
        title=run.physics,
        seconds=run.time,
        position=run.position,
        angle=run.rotation,
        facts=(("physics", run.physics),),
    )


def _film(one: Any) -> Film:
    if isinstance(one, Film):
        return one
    if isinstance(one, str) and not one:
        raise KinetixError("show: the path is empty")
    if isinstance(one, str | Path):
        if Path(one).suffix == ".npz" or (os.path.isfile(one) and zipfile.is_zipfile(one)):
            return film_of_file(Path(one))
        one = _level_of(one)
    if isinstance(one, Level):
        bodies = one.bodies
        return Film(
            level=one,
            title=one.name,
            seconds=np.zeros(1),
            position=np.array([body.position for body in bodies], float).reshape(1, -1, 2),
            angle=np.array([[body.angle for body in bodies]], float),
        )
    if type(one).__name__ == "Run":  # its module imports JAX
        return film_of_run(one)
    raise KinetixError(
        "show: expected a run of kinetix.simulate, the file of an episode (.npz), a film or a "
        f"level, got {type(one).__name__}; kinetix.level_of(state, name=…) makes a level of a state"
    )


def _level_of(name: str | Path) -> Level:
    """Return the level of a file or name.

    Raises:
        KinetixError: The level does not exist.
    """
    try:
        return load_level(name)
    except LevelError as error:
        raise KinetixError(
            "show: expected the file or the name of a level, or the file of an episode (.npz): "
            f"{error}"
        ) from error
