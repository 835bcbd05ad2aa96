"""The Help menu's rows about the app itself: version, folders, documentation."""

import functools
import importlib.metadata
import os

from editor.base.prompts import Choice, Question
from editor.session import Session
from kinetix.paths import config_dir, docs_dir, state_dir, user_agents_dir, user_levels_dir
from kinetix.version import __version__


def show_about(session: Session) -> None:
    """Show the version and where the app keeps what."""
    _tell(
        session,
        "Kinetix",
        f"Version {__version__}, MIT license\n\n"
        f"Levels: {user_levels_dir()}\n"
        f"Agents: {user_agents_dir()}\n"
        f"Settings: {config_dir()}\n"
        f"Reports of crashes, copies of unsaved work: {state_dir()}",
    )


def show_documents(session: Session) -> None:
    """Show where the documents are: their address, or the folder beside the app."""
    _tell(session, "Documentation", documents())


@functools.cache
def documents() -> str:
    """Return the address of the documents, or the path of their first page; empty: neither is."""
    try:
        urls = importlib.metadata.metadata("kinetix-editor").get_all("Project-URL") or []
    except importlib.metadata.PackageNotFoundError:
        urls = []
    known = dict(url.split(", ", 1) for url in urls if ", " in url)
    if "Documentation" in known:
        return known["Documentation"]
    first = docs_dir() / "index.md"
    return str(first) if os.path.isfile(first) else ""


def _tell(session: Session, title: str, message: str) -> None:
    def answer(choice: str) -> None:
        if choice == "copy":
            session.clipboard.set(message)
            session.toast("Copied", "success")

    session.ask(
        Question(
            title=title,
            message=message,
            choices=(Choice(id="copy", label="Copy"), Choice(id="ok", label="OK")),
            default="ok",
            cancel="ok",
            answer=answer,
        )
    )
