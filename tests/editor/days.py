"""The user's folders as earlier runs leave them: empty, yesterday's, or an older version's."""

import json
import os
import shutil
from pathlib import Path

from editor.actions.files import file, recover
from editor.base.settings import Settings, SettingsKeeper
from editor.documents.autosaves import Autosaves
from editor.documents.commands.fields import SetField
from editor.documents.commands.group import Move
from editor.documents.old_names import OldNames
from editor.gallery.kept_set import KeptSet
from editor.gallery.results import HUMAN, Results
from editor.hosts.headless import HeadlessHost
from editor.session import Session
from editor.worker.jobs import Worker
from editor.worker.requests import Progress, Request
from kinetix.level.codec import level_hash, load_level, save_level
from kinetix.level.model import Level

FIRST, SECOND = "first day", "second day"
DAYS = (FIRST, SECOND)
OLD = Path(__file__).resolve().parent / "stored" / "0.1.0"
"""Folders of version 0.1.0 after two starts: its settings have lost their docks."""
FOLDERS = ("state", "config", "cache", "data", "documents")


def refuse(request: Request, progress: Progress) -> None:
    """No simulation here: JAX must not be imported."""
    raise AssertionError(f"{request} was asked of the worker by {progress}")


def folders(home: Path) -> dict[str, str]:
    """The environment that puts the user's folders below a folder."""
    names = {name: f"XDG_{name.upper()}_HOME" for name in FOLDERS[:-1]}
    return {variable: str(home / name) for name, variable in names.items()} | {
        "XDG_DOCUMENTS_DIR": str(home / "documents")
    }


def a_session(worker: Worker, level: Level | None = None) -> Session:
    """A session as the app begins it, with the question about earlier work put off."""
    settings = Settings.load()
    session = Session(
        settings=settings,
        keeper=SettingsKeeper(settings),
        results=Results(),
        old_names=OldNames(),
        kept_set=KeptSet(),
        worker=worker,
        level=level,
    )
    recover.offer(session)
    for prompt in list(session.prompts):
        session.answer(prompt, "later")
    return session


def live_through(home: Path, worker: Worker) -> None:
    """Use the app for a day below `home`: open, edit, save, be killed with work unsaved."""
    before = {name: os.environ.get(name) for name in folders(home)}
    os.environ.update(folders(home))
    try:
        session = a_session(worker)
        session.autosaves = Autosaves()
        path = home / "documents" / "yesterday.json"
        path.parent.mkdir(parents=True)
        save_level(load_level("s/first_flight"), path)
        host = HeadlessHost(session)
        host.frames(50)
        file.open_path(session, path)
        host.frames(10)
        first = session.document.level.bodies[0].id
        session.execute(SetField(ids=(first,), field="name", value="Lander"))
        session.results.add_episode(HUMAN, level_hash(session.document.level), won=True)
        session.execute(Move(ids=(first,), shift=(0.1, 0.0)))
        session.save_aside()
        host.ui.save_layout()
        session.keeper.save()
        # As after a kill: the copy stays, and nobody holds its run's lock.
        session.autosaves.end()
        session.library.stop()
        session.evaluator.stop()
        host.close()
    finally:
        for name, value in before.items():
            os.environ.pop(name) if value is None else os.environ.update({name: value})


def put(earlier: Path, home: Path) -> None:
    """Copy what a day has left into the user's folders below `home`."""
    for name in FOLDERS:
        if (earlier / name).is_dir():
            shutil.copytree(earlier / name, home / name, dirs_exist_ok=True)


def put_old(home: Path) -> None:
    """Copy what version 0.1.0 has left, but for changed keys and the unsaved work."""
    for name in ("config", "state"):
        shutil.copytree(OLD / name, home / name, dirs_exist_ok=True)
    shutil.rmtree(home / "state" / "kinetix-editor" / "autosave")
    path = home / "config" / "kinetix-editor" / "settings.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | {"keys": {}}))
