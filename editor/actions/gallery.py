"""Actions of the gallery: open it, open, rename, duplicate and delete levels."""

import os
from collections.abc import Callable, Generator
from pathlib import Path
from typing import Final

from editor.actions import agents, file, many_files, measure, outside, unsaved
from editor.actions.evaluating import if_free
from editor.base.prompts import FileQuestion, TextQuestion
from editor.gallery import filing
from editor.gallery.card import Card
from editor.gallery.filing import Trashed
from editor.gallery.named_levels import set_name, sets_naming
from editor.play.mode import Mode
from editor.session import Session
from kinetix.errors import CommandError, LevelError
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
        CommandError: None is.
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
    """Measure agents on the chosen levels, as the fields of *Evaluate* say."""
    who, form = session.viewer.measured, session.viewer.form
    if not who:
        agents.choose("a")(session)
        raise CommandError("Choose an agent first, then evaluate again.")
    levels = tuple(card.path for card in chosen_cards(session))

    def start() -> None:
        measure.start_evaluation(
            session,
            who,
            levels,
            attempts=form.attempts,
            seed=form.seed,
            physics=form.physics,
            deterministic=session.viewer.deterministic,
        )
        session.gallery.open = False
        session.view.front, session.view.levels_to_measure = "evaluate", "chosen"

    if_free(session, start)


def move(steps: Callable[[Session], int]) -> Callable[[Session], None]:
    """An action that goes on by some cards."""

    def run(session: Session) -> None:
        gallery = session.gallery
        gallery.move(gallery.shown(session.library, session.results), steps(session))

    return run


def select_all(session: Session) -> None:
    """Choose all that is shown."""
    gallery = session.gallery
    gallery.selection = tuple(card.path for card in gallery.shown(session.library, session.results))


def _guard_file(session: Session, path: Path) -> None:
    """Refuse what would take a file away from under unsaved changes, or from the app itself.

    Raises:
        CommandError: With the reason.
    """
    if filing.bundled(path):
        raise CommandError(f"{path.name} came with the app: duplicate it and change the copy.")
    index = session.tabs.locate(path)
    if index is not None and session.tabs[index].document.dirty:
        raise CommandError(f"{path.name} has unsaved changes: save or close it first.")


def rename(session: Session) -> None:
    """Ask for another name of the chosen level."""
    card, *others = chosen_cards(session)
    if others:
        raise CommandError("Choose one level to be renamed.")
    _guard_file(session, card.file)

    def answer(name: str | None) -> None:
        if name is None or name == card.name:
            return
        index = session.tabs.locate(card.file)
        target = filing.rename(card.file, name)
        session.old_names.move(card.file, target)
        if index is not None:
            document = session.tabs[index].document
            document.path = target
            outside.take(session, document)
        gallery = session.gallery
        gallery.selection, gallery.focus = (str(target),), str(target)
        gallery.renamed(card.path, str(target))
        look(session)
        if target != card.file:
            _tell_sets(session, [card.file])

    session.ask(TextQuestion(title="Rename level", text=card.name, accept="Rename", answer=answer))


def _tell_sets(session: Session, gone: list[Path]) -> None:
    """Say which level sets name files that are not there any more."""
    names = [set_name(path) for path in sets_naming(gone, session.library.sets)]
    if names:
        session.toast(f"Level sets that miss a level now: {unsaved.listed(names)}", "warning")


def duplicate(session: Session) -> None:
    """Copy the chosen levels; copies of the app's own go to the user's folder.

    Raises:
        LevelError: Some cannot be copied; the others are.
    """
    cards = chosen_cards(session)
    many_files.begin(session, "Copying levels", len(cards), _duplicated(session, cards))


def _duplicated(session: Session, cards: list[Card]) -> Generator[None]:
    made, failed, reason = [], 0, None
    try:
        for card in cards:
            try:
                made.append(filing.duplicate(card.file))
            except LevelError as error:
                failed += 1
                reason = reason or error
            yield
    finally:
        if made:
            session.gallery.selection = tuple(map(str, made))
            session.gallery.focus, session.gallery.scroll = str(made[0]), True
            told = f"Made {made[0]}" if len(made) == 1 else f"Made {len(made)} copies"
            session.toast(told, "success")
            look(session)
    if reason is not None:
        raise LevelError(f"{reason}{_and_more(failed)}")


def delete(session: Session) -> None:
    """Move the chosen levels to the trash."""
    chosen = chosen_cards(session)
    for card in chosen:
        _guard_file(session, card.file)
    many_files.begin(session, "Deleting levels", len(chosen), _deleted(session, chosen))


def _deleted(session: Session, cards: list[Card]) -> Generator[None]:
    thrown = []
    try:
        for card in cards:
            thrown.append(filing.throw_away(card.file))
            yield
    finally:
        if thrown:
            session.gallery.thrown.append(tuple(thrown))
            name = cards[0].name if len(thrown) == 1 else f"{len(thrown)} levels"
            session.toast(f"Moved {name} to the trash", action="gallery.restore")
        session.gallery.selection = ()
        for one in thrown:
            weight = session.gallery.tray.pop(str(one.origin), None)
            if weight is not None:
                session.gallery.thrown_weights[one.origin] = weight
        look(session)
        _tell_sets(session, [one.origin for one in thrown])


def can_restore(session: Session) -> bool:
    """Return whether something was deleted that can come back."""
    return bool(session.gallery.thrown)


def restore(session: Session) -> None:
    """Bring back what was deleted last; what cannot come back now waits behind all others.

    Raises:
        LevelError: Something cannot.
    """
    if session.gallery.work is not None:  # Before what it takes is gone from the list.
        raise CommandError(many_files.BUSY)
    thrown = session.gallery.thrown.pop()
    many_files.begin(session, "Bringing levels back", len(thrown), _restored(session, thrown))


def _restored(session: Session, thrown: tuple[Trashed, ...]) -> Generator[None]:
    back, reason = [], None
    waiting = dict.fromkeys(thrown)
    try:
        for one in thrown:
            try:
                filing.bring_back(one)
                back.append(one)
                del waiting[one]
            except LevelError as error:
                reason = reason or error
            yield
    finally:
        for one in back:
            weight = session.gallery.thrown_weights.pop(one.origin, None)
            if weight is not None:
                session.gallery.tray[str(one.origin)] = weight
        if waiting:
            session.gallery.thrown.insert(0, tuple(waiting))
        session.gallery.selection = tuple(str(one.origin) for one in back)
        look(session)
    if reason is not None:
        raise LevelError(f"{reason}{_and_more(len(waiting))}")


def _and_more(count: int) -> str:
    """Return what follows the first of some reasons."""
    return f" (and {count - 1} more)" if count > 1 else ""


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
