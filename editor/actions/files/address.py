"""Levels, episodes and comparisons from an address: fetched aside, then opened as files are."""

import contextlib
import tempfile
from pathlib import Path

from editor.actions.evaluation import comparison
from editor.actions.files import export, file
from editor.actions.gallery import level_sets
from editor.base.prompts import TextQuestion
from editor.documents.document import Document
from editor.play.trace_files import SUFFIX
from editor.session import Session
from kinetix.agents.stored_comparison import is_comparison
from kinetix.errors import KinetixError
from kinetix.files.address import fetch, is_address, name_of
from kinetix.level.codec import load_level
from kinetix.level.sets import is_set_file


def ask(session: Session) -> None:
    """Ask for an address and open what is there."""

    def answer(words: str | None) -> None:
        if words:
            open_address(session, words.strip())

    session.ask(
        TextQuestion(
            title="Address of a level, an episode (.npz) or a comparison",
            text="https://",
            accept="Open",
            answer=answer,
        )
    )


def open_address(session: Session, address: str) -> None:
    """Open what lies at an address; a window reports it where that cannot be done.

    Args:
        session: The app; it goes on while the server answers.
        address: Begins with `https://` or `http://`.
    """
    if not is_address(address):
        file.tell(
            session,
            "This cannot be opened",
            f"{address}: expected an address that begins with https:// or http://",
        )
        return
    session.toast(f"Fetching {name_of(address)} …")
    session.fetches.begin(
        lambda: fetch(address, "trace"), lambda told: _arrived(session, address, told)
    )


def _arrived(session: Session, address: str, told: bytes | KinetixError) -> None:
    if isinstance(told, KinetixError):
        file.tell(session, "This cannot be opened", str(told))
        return
    with contextlib.ExitStack() as stack:
        try:
            path = Path(stack.enter_context(tempfile.TemporaryDirectory())) / name_of(address)
            path.write_bytes(told)
        except OSError as error:
            why = error.strerror or error
            sentence = f"{address} was fetched, but cannot be kept in a temporary folder: {why}"
            file.tell(session, "This cannot be opened", sentence)
            return
        if told[:2] == b"PK":
            export.open_trace(session, path.rename(path.with_suffix(SUFFIX)))
        elif is_comparison(path):
            comparison.open_comparison(session, path)
        else:
            _level(session, path)


def _level(session: Session, path: Path) -> None:
    """Open a fetched level without a file: it is nobody's until it is saved."""
    try:
        level = load_level(path)
    except KinetixError as error:
        file.tell(session, "This cannot be opened", str(error))
        return
    session.gallery.open = False
    document = Document(level)
    document.mark_unsaved()
    session.open_tab(document)


def open_any(session: Session, words: str) -> bool:
    """Open a level, a set, an episode, a comparison or an address; whether it is, or on its way."""
    if is_address(words):
        open_address(session, words)
        return True
    path = Path(words)
    suffix = path.suffix.lower()
    if suffix == SUFFIX:
        return export.open_trace(session, path)
    if suffix == ".json" and is_comparison(path):
        return comparison.open_comparison(session, path)
    if suffix == ".json" and is_set_file(path):
        return level_sets.open_set(session, path)
    return file.open_path(session, path)
