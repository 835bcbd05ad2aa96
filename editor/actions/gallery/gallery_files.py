"""Actions of the level files in the gallery: rename, copy, move, delete, bring back."""

from collections.abc import Generator
from pathlib import Path

from editor.actions.files import external_change, unsaved
from editor.actions.gallery import gallery, many_files
from editor.base.prompts import FileQuestion, TextQuestion
from editor.documents.document import Document
from editor.gallery import filing
from editor.gallery.card import Card
from editor.gallery.filing import MovedFile
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
    document = _open_document(session, path)
    if document is not None and document.dirty:
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
        document = _open_document(session, card.file)
        target = filing.rename(card.file, name)
        _follow(session, document, card.file, target)
        if document is not None:
            external_change.take(session, document)
        session.gallery.selection, session.gallery.focus = (str(target),), str(target)
        gallery.look(session)
        if target != card.file:
            _tell_sets(session, [card.file])

    session.ask(TextQuestion(title="Rename level", text=card.name, accept="Rename", answer=answer))


def _open_document(session: Session, path: Path) -> Document | None:
    """Return the level of a tab that shows a file."""
    index = session.tabs.locate(path)
    return None if index is None else session.tabs[index].document


def _follow(session: Session, document: Document | None, old: Path, new: Path) -> None:
    """Let all that names a file by its path follow it to another one.

    Args:
        session: The app.
        document: The level in the tab that shows the file, if one does.
        old: Where the file was.
        new: Where it is.
    """
    session.old_names.move(old, new)
    session.gallery.renamed(str(old), str(new))
    recents = session.settings.recents
    session.settings.recents = [str(new) if path == str(old) else path for path in recents]
    if document is not None:
        document.path = new


def _tell_sets(session: Session, gone: list[Path]) -> None:
    """Report which level sets name files that are not there any more."""
    names = [set_name(path) for path in sets_naming(gone, session.library.sets)]
    if names:
        session.toast(f"Level sets that miss a level now: {unsaved.listed(names)}", "warning")


def duplicate(session: Session) -> None:
    """Copy the chosen levels; copies of the app's own go to the user's folder.

    Raises:
        LevelError: Some levels cannot be copied; the others are.
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


def move_to(session: Session) -> None:
    """Ask for the folder that the chosen levels go to."""
    cards = gallery.chosen_cards(session)
    own = gallery.folders(session)[-1]

    def answer(folder: Path | None) -> None:
        if folder is not None:
            put_into(session, folder)

    session.ask(
        FileQuestion(
            purpose="folder",
            title="Move to which folder?",
            folder=own if filing.bundled(cards[0].file) else cards[0].file.parent,
            fresh=True,
            answer=answer,
        )
    )


def put_into(session: Session, folder: Path, *, copies: bool = False) -> None:
    """Move the chosen levels to a folder; the app's own are copied.

    Args:
        session: The app.
        folder: Where they go; made if it is not there. From now on the gallery shows it.
        copies: True if all stay where they are, and copies of them go there.

    Raises:
        CommandError: The levels of the folder came with the app, or all are there already.
    """
    cards = gallery.chosen_cards(session)
    if filing.bundled(folder):
        raise CommandError("This folder came with the app: choose one of your own.")
    stays = {card.path for card in cards if copies or filing.bundled(card.file)}
    cards = [card for card in cards if card.path in stays or card.file.parent != folder]
    if not cards:
        raise CommandError(f"That is the folder of these levels: {folder}.")
    for card in cards:
        if card.path not in stays:
            _guard_file(session, card.file)
    title = "Copying levels" if len(stays) == len(cards) else "Moving levels"
    many_files.begin(session, title, len(cards), _put(session, cards, folder, stays))


def _put(session: Session, cards: list[Card], folder: Path, stays: set[str]) -> Generator[None]:
    copied: list[Path] = []
    moved: list[MovedFile] = []
    try:
        for card in cards:
            if card.path in stays:
                copied.append(filing.copy_into(card.file, folder))
            else:
                document = _open_document(session, card.file)
                one = filing.move_into(card.file, folder)
                moved.append(one)
                _follow(session, document, one.origin, one.file)
            yield
    finally:
        if moved:
            session.gallery.moved.append(tuple(moved))
        _tell_put(session, copied, [one.file for one in moved], folder)
        _tell_sets(session, [one.origin for one in moved])


def _tell_put(session: Session, copied: list[Path], moved: list[Path], folder: Path) -> None:
    """Say where levels are now, and show them there."""
    if not (copied or moved):
        return
    if moved:
        session.toast(f"Moved {_named(moved)} to {folder}", "success", action="gallery.restore")
    if copied:
        session.toast(f"Copied {_named(copied)} to {folder}", "success")
    there = [*moved, *copied]
    session.gallery.selection = tuple(map(str, there))
    session.gallery.focus = str(there[0])
    if any(folder.is_relative_to(shown) for shown in gallery.folders(session)):
        gallery.look(session)
    else:
        gallery.include_folder(session, folder)


def _named(files: list[Path]) -> str:
    """Return the name of the only file, or how many there are."""
    return files[0].stem if len(files) == 1 else f"{len(files)} levels"


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
            session.gallery.moved.append(tuple(thrown))
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
    """Return whether something was deleted or moved that can come back."""
    return bool(session.gallery.moved)


def restore(session: Session) -> None:
    """Bring back what was deleted or moved last; what cannot come back now waits behind all others.

    Raises:
        LevelError: Something cannot.
    """
    if session.gallery.work is not None:  # Before what it takes is gone from the list.
        raise CommandError(many_files.BUSY)
    moved = session.gallery.moved.pop()
    many_files.begin(session, "Bringing levels back", len(moved), _restored(session, moved))


def _restored(session: Session, moved: tuple[MovedFile, ...]) -> Generator[None]:
    back, reason = [], None
    waiting = dict.fromkeys(moved)
    try:
        for one in moved:
            try:
                document = _open_document(session, one.file)
                filing.bring_back(one)
                back.append(one)
                del waiting[one]
                _follow(session, document, one.file, one.origin)
            except LevelError as error:
                reason = reason or error
            yield
    finally:
        for one in back:
            weight = session.gallery.thrown_weights.pop(one.origin, None)
            if weight is not None:
                session.gallery.tray[str(one.origin)] = weight
        if waiting:
            session.gallery.moved.insert(0, tuple(waiting))
        session.gallery.selection = tuple(str(one.origin) for one in back)
        gallery.look(session)
    if reason is not None:
        raise LevelError(f"{reason}{_and_more(len(waiting))}")


def _and_more(count: int) -> str:
    """Return what follows the first of some reasons."""
    return f" (and {count - 1} more)" if count > 1 else ""
