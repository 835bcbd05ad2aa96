"""A process that edits without end, to be killed in the middle."""

from multiprocessing.connection import Connection
from pathlib import Path

from editor.documents import autosaves, files, recovery
from editor.documents.autosaves import Autosaves
from editor.documents.commands.level import ReplaceLevel


def edit_for_ever(base: Path, path: Path, told: Connection) -> None:
    """Edit a level over and over; tell what the screen shows at the moment of every copy.

    It goes on from the newest of the file and what an earlier run left.
    """
    autosaves.PAUSE = 0.0
    run = Autosaves(base)
    document = files.open_document(path)
    found = recovery.find(base).recoveries
    number = int(document.level.description or 0)
    for each in found:
        if int(each.level.description) < number:  # killed between saving and removing the copy
            recovery.discard(each)
            continue
        number = int(each.level.description)
        document.commit(ReplaceLevel(level=each.level, label="Restore"))
        document.origin = (each.file, *each.origin)
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
