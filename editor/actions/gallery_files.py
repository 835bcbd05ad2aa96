"""Actions of the level files in the gallery: rename, copy, delete them and bring them back."""

from collections.abc import Generator
from pathlib import Path

from editor.actions import gallery, many_files, outside, unsaved
from editor.base.prompts import TextQuestion
from editor.gallery import filing
from editor.gallery.card import Card
from editor.gallery.filing import Trashed
from editor.gallery.named_levels import set_name, sets_naming
from editor.session import Session
from kinetix.errors import CommandError, LevelError


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
    card, *others = gallery.chosen_cards(session)
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
        view = session.gallery
        view.selection, view.focus = (str(target),), str(target)
        view.renamed(card.path, str(target))
        gallery.look(session)
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
    cards = gallery.chosen_cards(session)
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
            gallery.look(session)
    if reason is not None:
        raise LevelError(f"{reason}{_and_more(failed)}")


def delete(session: Session) -> None:
    """Move the chosen levels to the trash."""
    chosen = gallery.chosen_cards(session)
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
        gallery.look(session)
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
        gallery.look(session)
    if reason is not None:
        raise LevelError(f"{reason}{_and_more(len(waiting))}")


def _and_more(count: int) -> str:
    """Return what follows the first of some reasons."""
    return f" (and {count - 1} more)" if count > 1 else ""
