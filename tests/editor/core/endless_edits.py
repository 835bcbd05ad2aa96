"""A process that edits without end, to be killed in the middle."""

from multiprocessing.connection import Connection
from pathlib import Path

from editor.documents import autosaves, files, recovery
from editor.documents.autosaves import Autosaves
from editor.documents.commands.level import ReplaceLevel


def edit_for_ever(base: Path, path: Path, told: Connection) -> None:
    """Edit a level over and over; tell what the screen shows at the moment of every copy."""
    autosaves.PAUSE = 0.0
    run = Autosaves(base)
    document = files.open_document(path)
    found = recovery.find(base).recoveries
    number = int(document.level.description or 0)
    if found:
        number = int(found[0].level.description)
        document.commit(ReplaceLevel(level=found[0].level, label="Restore"))
        document.origin = (found[0].file, *found[0].origin)
    told.send((number, len(found)))
    while True:
        number += 1
        level = document.level.replace(description=str(number))
        document.commit(ReplaceLevel(level=level, label="Edit"))
        run.follow([document])
        if number % 3:
            run.flush()
            told.send(number)
        if number % 40 == 0:
            run.flush()
            files.save_document(document, path, "kinetix-level")
            told.send(number)
            run.follow([document])
