"""The folder and the name that are chosen in the file browser, and whether they can be used."""

import os
from pathlib import Path
from typing import Final

from editor.base.prompts import FileQuestion
from kinetix.files.names import LONGEST_NAME, is_text
from kinetix.paths import user_levels_dir

LEVEL: Final = ".json"
"""Ending of level files."""


class FileChoice:
    """The folder on show and the name that was typed or clicked, for one question."""

    def __init__(self, question: FileQuestion) -> None:
        self.question = question
        self.folder = question.folder if self._can_show(question.folder) else Path.home()
        self.name = question.name
        self.error = question.error
        """Sentence about what is wrong; empty: nothing is."""
        self.hidden = ""
        """A line about the files that are not listed because their names are not text; or empty."""
        self.overwrite: Path | None = None
        """A file that has this name already: accepting once more replaces it."""
        self.missing: Path | None = None
        """A folder that is not there: accepting once more makes it."""
        self.unreadable = ""
        """Sentence about why the folder on show cannot be listed; empty: it can."""
        self.to_name = True
        """True if the keyboard goes to the name in the next frame."""

    @property
    def saving(self) -> bool:
        """True if a name to save under is asked for."""
        return self.question.purpose == "save"

    @property
    def folders_only(self) -> bool:
        """True if a folder is asked for."""
        return self.question.purpose == "folder"

    def enter(self, name: str) -> None:
        """Take a name as it is being typed."""
        if name != self.name:
            self.name = name
            self._begin_anew()

    def pick(self, path: Path) -> None:
        """Take a file of the folder."""
        self.name, self.to_name = path.name, True
        self._begin_anew()

    def _begin_anew(self) -> None:
        """Forget what was asked back about another name or folder."""
        self.error, self.overwrite, self.missing = "", None, None

    def _can_show(self, folder: Path) -> bool:
        """Return whether a folder is there; the user's own is made when something is saved."""
        return os.path.isdir(folder) or (not self.folders_only and folder == user_levels_dir())

    def go(self, folder: Path) -> None:
        """Show another folder, if it is there."""
        if self._can_show(folder):
            self.folder, self.to_name = folder, True
            self._begin_anew()

    def entries(self) -> list[Path]:
        """Return the folders on show, then the files that could be meant, by name."""
        self.unreadable = ""
        try:
            every = [path for path in self.folder.iterdir() if not path.name.startswith(".")]
        except OSError as error:
            if self.folder == user_levels_dir() and isinstance(error, FileNotFoundError):
                return []
            self.unreadable = f"{self.folder}: {error.strerror or error}"
            return []
        found = [path for path in every if is_text(path.name)]
        hidden = len(every) - len(found)
        self.hidden = f"{hidden} here cannot be shown: no Unicode names." if hidden else ""
        kept = [
            path
            for path in found
            if os.path.isdir(path)
            or (path.suffix.lower() in self.question.suffixes and not self.question.as_folder)
        ]
        return sorted(kept, key=lambda path: (not os.path.isdir(path), path.name.lower()))

    def fresh(self) -> Path | None:
        """Return the folder that is not there yet and was named, where that is allowed."""
        if not (self.question.fresh and self.name):
            return None
        path = self._typed()
        allowed = not os.path.exists(path) and os.path.isdir(path.parent)
        return path if allowed else None

    def _typed(self) -> Path:
        """Return the path that the name means, from the folder on show on."""
        name = self.name.strip() if self.saving else self.name
        try:
            path = self.folder / Path(name).expanduser()
        except RuntimeError:  # ~ of a user that does not exist
            path = self.folder / name
        return path.resolve() if ".." in path.parts else path

    def type_folder(self) -> None:
        """Go to the folder whose name was typed."""
        path = self._typed()
        if os.path.isdir(path):
            self.go(path)
            self.name = ""
        else:
            self.error = f"There is no folder {path}."

    def accept(self) -> tuple[bool, Path | None]:
        """Return whether the user is done, and the path."""
        if self.saving and not self.name.strip():
            self.error = "A name needs more than blanks."
            return False, None
        path = self._typed()
        # Where a folder is saved its name means itself; with a slash, as in `sets/`, its inside.
        if os.path.isdir(path) and (
            not self.question.as_folder or self.name.endswith(("/", os.sep))
        ):
            self.go(path)
            self.name = ""
            return False, None
        if self.saving:
            return self._accept_new(path)
        if not os.path.isfile(path):
            self.error = f"There is no file {path.name} here."
            return False, None
        return True, path

    def _accept_new(self, path: Path) -> tuple[bool, Path | None]:
        """Return whether the user is done with a path to save under, and the path with ending."""
        as_folder = self.question.as_folder
        if path.name.lower() in self.question.suffixes:
            self.error = f"A name belongs before {path.name}."
            return False, None
        if as_folder:
            path = path.with_name(path.name.removesuffix(LEVEL))
        elif path.suffix.lower() not in self.question.suffixes:
            path = path.with_name(f"{path.name}{self.question.suffixes[0]}")
        if len(os.fsencode(path.name)) > LONGEST_NAME:
            self.error = f"{path.name[:20]}…: this name is too long for a file."
            return False, None
        if os.path.isfile(path) and as_folder:
            self.error = f"{path.name} is a file: choose another name for the folder."
            return False, None
        if os.path.exists(path) and self.overwrite != path:
            self.overwrite = path
            return False, None
        return self._has(path.parent), path

    def _has(self, folder: Path) -> bool:
        """Return whether a folder is there to save in: it is made, after asking back once."""
        if os.path.isdir(folder):
            return True
        if self.missing != folder and folder != user_levels_dir():
            self.missing = folder
            return False
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            self.error = f"{folder}: cannot be made: {error.strerror or error}"
            return False
        return True

    def told(self, accept: str) -> str:
        """Return what is wrong, or what accepting once more does; empty where neither is.

        Args:
            accept: Words of the button that accepts.
        """
        if self.error:
            return self.error
        if self.missing is not None:
            return f"There is no folder {self.missing.name}. Press {accept} to make it."
        if self.overwrite is not None:
            return f"{self.name} is there already. Press {accept} to replace it."
        return ""


def nothing_here(question: FileQuestion) -> str:
    """Return what an empty folder is said to lack."""
    if question.purpose == "folder" or question.as_folder:
        return "No folders here."
    if question.suffixes == (LEVEL,) and question.about is None:
        return "No folders and no level files here."
    return f"No folders and no {' or '.join(question.suffixes)} files here."
