"""Everything that writes: one row a writer, with what must hold after it was killed."""

import dataclasses
import itertools
import os
from collections.abc import Callable
from pathlib import Path

from tests.attack import training
from tests.attack.clock import PATIENCE


@dataclasses.dataclass(frozen=True, kw_only=True)
class Writer:
    """Something that is written again and again."""

    write: Callable[[Path, int], None]
    """Writes content number `k` below a folder."""
    read: Callable[[Path], int]
    """Reads it and returns its number; raises when it is not whole."""
    longest: float = 0.03
    """Longest life of a child after it has begun [s]."""
    kills: int = 40
    """Kills in one round."""
    modules: tuple[str, ...] = ()
    """Imported before children are forked, so that they die writing, not importing; none of them
    may start JAX."""
    begun: Callable[[Path], object] | None = None
    """Tells from the folder when a child has begun; None: it begins at once."""
    last: Callable[[Path], None] | None = None
    """Check at the end."""


def _level(number: int):
    from kinetix.level.codec import load_level

    return load_level("s/first_flight").replace(name=f"number {number}")


def write_level(folder: Path, number: int) -> None:
    from kinetix.level.codec import save_level

    save_level(_level(number), folder / "x.json")


def read_level(folder: Path) -> int:
    from kinetix.level.codec import load_level

    return int(load_level(folder / "x.json").name.split()[1])


def write_set(folder: Path, number: int) -> None:
    from kinetix.level.sets import build_set, gather_levels, save_set

    made = build_set(gather_levels(["s/first_flight"]), name=f"n {number}", folder=folder)
    save_set(made, folder / "set.json", inline=True)


def read_set(folder: Path) -> int:
    from kinetix.level.sets import load_set

    return int(load_set(folder / "set.json").manifest.name.split()[1])


def write_settings(folder: Path, number: int) -> None:
    from editor.base.settings import Settings

    Settings(save_folder=str(number)).save(folder / "settings.json")


def read_settings(folder: Path) -> int:
    from editor.base.settings import Settings

    return int(Settings.load(folder / "settings.json").save_folder)


def write_results(folder: Path, number: int) -> None:
    from editor.gallery.results import Record, Results, Trial

    record = Record(attempts=number, solved=0)
    Results(folder / "results.json").record(Trial(player="x"), {"a": record})


def read_results(folder: Path) -> int:
    from editor.gallery.results import Results, Trial

    return Results(folder / "results.json").of("a")[Trial(player="x")].attempts


def write_metrics(folder: Path, number: int) -> None:
    """One more row; the three files agree after the next start."""
    from kinetix.training.logging import MetricsLog

    log = MetricsLog(folder, updates=number - 1)
    row = {"timing/num_updates": number, "timing/num_env_steps": 10 * number}
    log.write(row | {f"loss/{number % 7}": 0.5})
    log.close()


def read_metrics(folder: Path) -> int:
    from kinetix.training.logging import read_metrics

    updates = [int(row["timing/num_updates"]) for row in read_metrics(folder)]
    assert updates == list(range(1, len(updates) + 1)), updates
    return len(updates)


def write_trace(folder: Path, number: int) -> None:
    import numpy as np

    from editor.play.trace_files import write_trace
    from editor.worker.snapshots import Snapshot, Trace

    level = _level(number)
    bodies = len(level.bodies)
    moment = Snapshot(
        step=0,
        position=np.zeros((bodies, 2), np.float32),
        angle=np.zeros(bodies, np.float32),
        velocity=np.zeros((bodies, 2), np.float32),
        angular_velocity=np.zeros(bodies, np.float32),
        motor=np.zeros(len(level.joints), np.float32),
        thruster=np.zeros(len(level.thrusters), np.float32),
    )
    trace = Trace(physics="fast", perturbed=False, snapshots=(moment,), actions=(), seed=number)
    write_trace(trace, level, folder / "x.npz")


def read_trace(folder: Path) -> int:
    from editor.play.trace_files import read_trace

    found = read_trace(folder / "x.npz")
    assert found.level.name == f"number {found.trace.seed}"
    return found.trace.seed


def write_agent(folder: Path, number: int) -> None:
    from kinetix.agents.checkpoint import read_checkpoint, write_checkpoint
    from kinetix.paths import checkpoints_dir

    card, params = read_checkpoint(checkpoints_dir() / "unicyclist")
    write_checkpoint(folder / "agent", card.replace(description=str(number)), params)


def read_agent(folder: Path) -> int:
    from kinetix.agents.agent import load_agent

    return int(load_agent(folder / "agent").card.description)


def write_kinetix_env_agent(folder: Path, number: int) -> None:
    from kinetix.agents.agent import Agent, save_agent
    from kinetix.agents.checkpoint import read_checkpoint
    from kinetix.paths import checkpoints_dir

    card, params = read_checkpoint(checkpoints_dir() / "unicyclist")
    agent = Agent(card.replace(description=str(number)), params)
    save_agent(agent, folder / "agent", format="kinetix-env")


def write_work(folder: Path, number: int) -> None:
    """A person at work: unsaved changes are copied, restored after a kill, now and then saved."""
    from editor import actions
    from editor.actions.files import recover
    from editor.actions.files.file import open_path
    from editor.documents import recovery
    from editor.documents.autosaves import PAUSE, Autosaves
    from editor.documents.commands.level import ReplaceLevel
    from editor.session import Session

    os.environ["XDG_STATE_HOME"] = str(folder / "state")
    now = itertools.count(0, PAUSE)
    file = folder / "x.json"
    if not file.exists():
        write_level(folder, number)
    session = Session(autosaves=Autosaves(clock=lambda: next(now)))
    open_path(session, file)
    for each in reversed(recovery.find().recoveries):
        recover.restore(session, each)
    for k in range(number, number + 5):
        session.execute(ReplaceLevel(level=_level(k), label="Edit"))
        for _ in range(3):
            session.autosaves.follow([tab.document for tab in session.tabs])
        session.autosaves.flush()
        if k % 3 == 0:
            actions.run(session, "file.save")
            session.autosaves.flush()
    session.autosaves.end()


def read_work(folder: Path) -> int:
    """The newest of what is saved and what is offered."""
    from editor.documents import recovery

    os.environ["XDG_STATE_HOME"] = str(folder / "state")
    found = recovery.find()
    assert not found.unreadable, found.unreadable
    numbers = [int(each.level.name.split()[1]) for each in found.recoveries]
    return max([read_level(folder), *numbers])


def write_gallery(folder: Path, number: int) -> None:
    """The gallery's index and thumbnails of levels that come and go."""
    from editor.gallery.library import Library

    (folder / "levels").mkdir(exist_ok=True)
    write_level(folder / "levels", number)
    library = Library(folder)
    library.look((folder / "levels",))
    assert library.wait(PATIENCE)
    library.stop()


def read_gallery(folder: Path) -> int:
    """Whatever the index says, the gallery shows the level as it is."""
    from editor.gallery.library import Library

    library = Library(folder)
    library.look((folder / "levels",))
    assert library.wait(PATIENCE)
    (card,) = library.cards
    library.want(library.cards)
    assert library.wait(PATIENCE)
    assert library.picture(card.sha256) is not None
    library.stop()
    return int(card.name.split()[1])


def write_page(folder: Path, number: int) -> None:
    from kinetix.pages.show import show

    show(_level(number)).save(folder / "x.html")


def read_page(folder: Path) -> int:
    page = (folder / "x.html").read_text()
    assert page.rstrip().endswith("</html>")
    return int(page.split("<title>number ")[1].split("<")[0])


WRITERS: dict[str, Writer] = {
    "level": Writer(write=write_level, read=read_level, modules=("kinetix.level.codec",)),
    "level set": Writer(
        write=write_set, read=read_set, longest=0.06, modules=("kinetix.level.sets",)
    ),
    "settings": Writer(write=write_settings, read=read_settings, modules=("editor.base.settings",)),
    "results": Writer(write=write_results, read=read_results, modules=("editor.gallery.results",)),
    "episode": Writer(write=write_trace, read=read_trace, modules=("editor.play.trace_files",)),
    "page": Writer(write=write_page, read=read_page, modules=("kinetix.pages.show",)),
    "gallery": Writer(
        write=write_gallery,
        read=read_gallery,
        longest=0.1,
        modules=("editor.gallery.library",),
    ),
    "unsaved work": Writer(
        write=write_work,
        read=read_work,
        longest=0.15,
        modules=("editor.session", "editor.actions.files.recover"),
    ),
    "metrics": Writer(
        write=write_metrics,
        read=read_metrics,
        longest=0.1,
        modules=("kinetix.training.logging",),
    ),
    "agent": Writer(
        write=write_agent,
        read=read_agent,
        longest=1.5,
        kills=3,
        modules=("kinetix.agents.checkpoint", "kinetix.agents.agent"),
        begun=lambda folder: os.stat(folder).st_mtime_ns,
    ),
    "agent of kinetix-env": Writer(
        write=write_kinetix_env_agent,
        read=read_agent,
        longest=0.5,
        kills=5,
        modules=("kinetix.agents.kinetix_env", "kinetix.agents.agent"),
        begun=lambda folder: os.stat(folder / "agent").st_mtime_ns,
    ),
    "training": Writer(
        write=training.write,
        read=training.read,
        longest=0.5,
        kills=10,
        modules=("kinetix.training.run", "kinetix.agents.agent"),
        begun=training.begun,
        last=training.ends_as_if_it_had_not_been_killed,
    ),
}
"""Everything that writes, by name."""
