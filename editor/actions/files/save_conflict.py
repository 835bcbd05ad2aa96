"""Saving a file that another program has saved meanwhile."""

from collections.abc import Callable
from pathlib import Path

from editor.actions.files import external_change
from editor.base.prompts import Choice, Question
from editor.documents.document import Document
from editor.documents.files import plain_reason
from editor.gallery.filing import free_path
from editor.session import Session
from kinetix.errors import LevelError
from kinetix.files.atomic import free_backup
from kinetix.level.codec import load_level
from kinetix.level.model import Level


def ask(
    session: Session,
    document: Document,
    path: Path,
    save: Callable[[Path], None],
    then: Callable[[], None] | None,
) -> None:
    """Ask which of two versions shall be kept; both are shown.

    Args:
        session: The app.
        document: What was to be saved.
        path: Its file, which another program has changed.
        save: Writes the document to a path.
        then: What comes after it is settled.
    """
    theirs, told = _theirs(path)

    def answer(choice: str) -> None:
        if choice == "both":
            save(free_path(path))
        elif choice == "mine":
            save(path)
        elif choice == "theirs":
            external_change.take(session, document)
            session.toast(f"Took {path.name} as it is", "success", action="edit.undo")
            if then is not None:
                then()

    choices = [
        Choice(id="both", label="Keep Both", detail=f"Save mine as {free_path(path).name}."),
        Choice(
            id="mine",
            label="Save Mine",
            detail=f"The other one is kept as {free_backup(path).name}.",
        ),
        Choice(id="theirs", label="Take Theirs", detail="As one edit: undo brings mine back."),
        Choice(id="cancel", label="Cancel"),
    ]
    if theirs is None:
        del choices[2]
    pictures = (("Mine", document.level),) + ((("In the file", theirs),) if theirs else ())
    session.ask(
        Question(
            title=f"{path.name} was changed by another program",
            message=f"Saving would replace what is there now. {told}",
            choices=tuple(choices),
            default="both",
            cancel="cancel",
            answer=answer,
            pictures=pictures,
        )
    )


def _theirs(path: Path) -> tuple[Level | None, str]:
    """Return the level in the file, and a sentence about it."""
    try:
        return load_level(path), ""
    except LevelError as error:
        return None, f"It cannot be read: {plain_reason(path, error)}"
