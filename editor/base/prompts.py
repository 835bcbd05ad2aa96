"""Questions of the session to the user: values that the dialogs draw and answer."""

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Literal, TypeAlias

from kinetix.level.model import Level


@dataclasses.dataclass(frozen=True, kw_only=True)
class Choice:
    """One button of a question or one row of a menu."""

    id: str
    label: str
    detail: str = ""
    """A further line in a quieter tone."""
    ids: tuple[int | str, ...] = ()
    """Entities to highlight while the row is hovered."""
    chord: str = ""
    """The keys that do the same, as actions name them."""
    separated: bool = False
    """True if a line stands above the row."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Question:
    """A modal question with buttons; Esc answers `cancel`, Enter answers `default`."""

    title: str
    message: str
    choices: tuple[Choice, ...]
    default: str
    cancel: str
    answer: Callable[[str], None]
    pictures: tuple[tuple[str, Level], ...] = ()
    """Levels to show beside each other, with what is said below."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class TextQuestion:
    """Asks for a line of text; Enter accepts it, Esc answers None."""

    title: str
    text: str = ""
    """Initial text, selected."""
    accept: str = "OK"
    """Label of the button."""
    answer: Callable[[str | None], None]


@dataclasses.dataclass(frozen=True, kw_only=True)
class FileQuestion:
    """Asks for a file to open, a name to save under, or a folder."""

    purpose: Literal["open", "save", "folder"]
    title: str
    folder: Path
    name: str = ""
    """Proposed file name when saving."""
    suffixes: tuple[str, ...] = (".json",)
    answer: Callable[[Path | None], None]
    """Called with the path, or None when the user gave up."""
    describe: Callable[[Path], str] | None = None
    """Says what a folder is, for the preview; empty where it is not what is asked for. None: any
    folder will do."""
    wanted: str = ""
    """Requirement on a folder, in words: `an agent or a training run`."""
    about: Callable[[Path], str] | None = None
    """Says what a file is, for the preview. None: `.json` files are levels."""
    fresh: bool = False
    """True if a folder that is not there yet may be named."""
    as_folder: bool = False
    """True if what is saved under the name is a folder."""
    error: str = ""
    """Error of the answer before."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class MenuQuestion:
    """A pop-up list at a place on the screen; a click elsewhere answers None."""

    title: str
    choices: tuple[Choice, ...]
    at: tuple[float, float] | None
    """Position [px]; None: in the middle."""
    answer: Callable[[str | None], None]


Prompt: TypeAlias = Question | TextQuestion | FileQuestion | MenuQuestion
