"""Actions of the gallery: open it, choose levels, open and measure them; its folders."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Final

from editor.actions.evaluation import measure
from editor.actions.evaluation.evaluating import if_free
from editor.actions.files import file
from editor.actions.gallery import many_files
from editor.actions.watching import agents
from editor.base.prompts import FileQuestion
from editor.gallery.card import Card
from editor.gallery.search import Wish
from editor.play.mode import Mode
from editor.session import Session
from kinetix.errors import CommandError
from kinetix.paths import levels_dir, user_levels_dir

MAX_OPENED: Final = 12
"""Most levels that are opened at once: each is a tab."""


def folders(session: Session) -> list[Path]:
    """Return the folders of the gallery: the app's levels, the user's, and the folders added."""
    found = [levels_dir(), user_levels_dir(), *map(Path, session.settings.gallery_folders)]
    return list(dict.fromkeys(path for path in found if os.path.isdir(path)))


def unreachable(session: Session) -> list[Path]:
    """Return the folders that the user has added and that cannot be looked into now."""
    added = map(Path, session.settings.gallery_folders)
    return [path for path in dict.fromkeys(added) if not os.path.isdir(path)]


def look(session: Session) -> None:
    """Look through the folders again, in the background."""
    session.library.look(folders(session))


def toggle(session: Session) -> None:
    """Show the gallery, or go back to the level; what is open stays as it is."""
    gallery = session.gallery
    gallery.open = not gallery.open
    if not gallery.open:
        return
    session.driver.cancel()
    session.release_all()
    if session.mode is Mode.PLAYING:
        session.playback.pause()
    look(session)


def search(session: Session) -> None:
    """Let the search field take the keyboard."""
    session.gallery.search()


def is_open(session: Session) -> bool:
    """Return whether the gallery is on the screen."""
    return session.gallery.open


def close(session: Session) -> None:
    """Back to the level; first the export's questions go, and work on files ends."""
    if session.gallery.work is not None:
        many_files.stop(session)
    elif session.gallery.plan is not None:
        session.gallery.plan = None
    else:
        session.gallery.open = False


def choosing(session: Session) -> bool:
    """Return whether levels are chosen in the gallery."""
    return session.gallery.open and bool(session.gallery.chosen(session.library, session.results))


def chosen_cards(session: Session) -> list[Card]:
    """Return the levels that are chosen.

    Raises:
        CommandError: No level is chosen.
    """
    chosen = session.gallery.chosen(session.library, session.results)
    if not chosen:
        raise CommandError("Choose a level first.")
    return chosen


def open_chosen(session: Session) -> None:
    """Open every chosen level in a tab."""
    chosen = chosen_cards(session)
    if len(chosen) > MAX_OPENED:
        raise CommandError(f"{len(chosen)} levels are too many tabs: choose up to {MAX_OPENED}.")
    opened = [file.open_path(session, card.file) for card in chosen]
    if any(opened):
        session.gallery.open = False


def play_agent(session: Session) -> None:
    """Open the chosen level and let agent A play it; without one, ask which."""
    first, *others = chosen_cards(session)
    if others:
        raise CommandError("Choose one level to be played.")
    if file.open_in_front(session, first.file):
        session.gallery.open = False
        agents.play_agent(session)


def evaluate(session: Session) -> None:
    """Measure agents on the chosen levels, with the settings of *Evaluate*."""
    levels = tuple(card.path for card in chosen_cards(session))
    _evaluate(session, levels, "chosen")


def evaluate_set(session: Session, path: Path) -> None:
    """Measure agents on the levels of a set, with the settings of *Evaluate*."""
    _evaluate(session, (str(path),), "set")


def _evaluate(session: Session, paths: tuple[str, ...], source: str) -> None:
    """Measure agents on levels, and let the fields of *Evaluate* name them."""
    who, form = session.viewer.measured, session.viewer.form
    if not who:
        agents.choose("a")(session)
        raise CommandError("Choose an agent first, then evaluate again.")

    def start() -> None:
        measure.start_evaluation(
            session,
            who,
            paths,
            attempts=form.attempts,
            seed=form.seed,
            physics=form.physics,
            deterministic=session.viewer.deterministic,
        )
        session.gallery.open, session.view.front = False, "evaluate"
        form.source, form.paths = source, () if source == "chosen" else paths

    if_free(session, start)


def move(steps: Callable[[Session], int]) -> Callable[[Session], None]:
    """Return an action that goes on by some cards."""

    def run(session: Session) -> None:
        gallery = session.gallery
        gallery.move(gallery.shown(session.library, session.results), steps(session))

    return run


def choose_folder(session: Session, folder: Path) -> None:
    """Show a folder alone, whatever is searched for, and choose all its levels."""
    session.gallery.folder, session.gallery.wish = folder, Wish()
    select_all(session)


def select_all(session: Session) -> None:
    """Choose all that is shown."""
    gallery = session.gallery
    gallery.selection = tuple(card.path for card in gallery.shown(session.library, session.results))


def include_folder(session: Session, folder: Path) -> None:
    """Show a folder's levels in the gallery, from now on."""
    name = str(folder.resolve())
    if name not in session.settings.gallery_folders:
        session.settings.gallery_folders.append(name)
    session.gallery.folder = folder.resolve()
    look(session)


def add_folder(session: Session) -> None:
    """Choose a folder whose levels the gallery shows too."""

    def answer(path: Path | None) -> None:
        if path is not None:
            include_folder(session, path)

    session.ask(
        FileQuestion(
            purpose="folder",
            title="Add a folder to the gallery",
            folder=Path.home(),
            answer=answer,
        )
    )


def remove_folder(session: Session, folder: Path) -> None:
    """Show a folder's levels no more; the files stay."""
    session.settings.gallery_folders = [
        name for name in session.settings.gallery_folders if Path(name) != folder
    ]
    if session.gallery.folder == folder:
        session.gallery.folder = None
    look(session)
