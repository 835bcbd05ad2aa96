"""Views beside the episode: the second player, training runs, the agent's observation."""

import functools
import os
from pathlib import Path
from typing import Final

from editor.actions.evaluation.measure import keep_results
from editor.actions.watching.agents import load_agent
from editor.agents.reasons import OVERLAYS
from editor.agents.run_watch import RunWatch
from editor.base.prompts import FileQuestion
from editor.play.mode import Mode
from editor.session import Session
from editor.worker.jobs import Job, JobState
from editor.worker.requests import Observe
from kinetix.errors import KinetixError
from kinetix.level.model import Level
from kinetix.paths import working_dir


def watch_run(session: Session, path: str | Path) -> None:
    """Point the viewer at a training run: its metrics live, its newest agent in slot A."""
    session.viewer.run.watch(str(path))
    session.view.front = "training"


def ask_run(session: Session) -> None:
    """Ask for the folder of a training run to watch."""

    def answer(path: Path | None) -> None:
        if path is not None:
            watch_run(session, path)

    session.ask(
        FileQuestion(
            purpose="folder",
            title="Folder of a training run",
            folder=working_dir(),
            answer=answer,
            describe=_about_run,
            wanted="a training run",
        )
    )


def ask_beside(session: Session) -> None:
    """Ask for another run whose curves are shown beside those of the watched one."""

    def answer(path: Path | None) -> None:
        if path is not None:
            add_run(session, str(path))

    session.ask(
        FileQuestion(
            purpose="folder",
            title="Folder of another training run",
            folder=Path(session.viewer.run.path).parent,
            answer=answer,
            describe=_about_run,
            wanted="a training run",
        )
    )


def add_run(session: Session, path: str) -> None:
    """Show the curves of another run beside those of the watched one; each run once."""
    viewer = session.viewer
    if path in (viewer.run.path, *(other.path for other in viewer.other_runs)):
        return
    other = RunWatch(session.worker)
    other.watch(path)
    viewer.other_runs = (*viewer.other_runs, other)


def _about_run(path: Path) -> str:
    files = ("metrics.jsonl", "checkpoints", "config.toml")
    found = any(os.path.exists(path / name) for name in files)
    return f"{path.name}: a training run." if found else ""


def update_viewer(session: Session, seconds: float) -> None:
    """Let a frame pass: the rival keeps step, runs are looked at, results are kept.

    Args:
        session: The app.
        seconds: Time that has passed for those who play [s].
    """
    viewer, playback = session.viewer, session.playback
    viewer.evaluation.tick()
    keep_results(session)
    viewer.run.tick(session.time, functools.partial(_newer, session))
    viewer.curriculum.watch(viewer.run.path)
    viewer.curriculum.tick(session.time)
    for other in viewer.other_runs:
        other.tick(session.time, lambda _: None)
    _rival(session, seconds)
    if viewer.eye_open:
        _look(session)
    _ask_why(session)
    if not playback.active:
        viewer.by_hand = False
    if playback.current is None:
        viewer.guest = None


def _newer(session: Session, steps: int) -> None:
    del steps
    if session.viewer.follow_run:
        load_agent(session, session.viewer.run.path, "a")


def _rival(session: Session, seconds: float) -> None:
    """Start, advance or stop the second episode so that it belongs to the one on show."""
    viewer, playback = session.viewer, session.playback
    rival = viewer.rival
    if not playback.active or viewer.arrangement == "off" or playback.level is None:
        if rival.active:
            rival.stop()
        viewer.compared_episode = -1
        return
    if viewer.compared_episode != playback.episode and not _challenge(session, playback.level):
        return
    try:
        alone = seconds * playback.speed if playback.mode is Mode.ENDED else None
        rival.tick(playback.engine_step, alone=alone)
    except KinetixError as error:
        session.toast(f"{rival.player}: {error}", "error")


def _challenge(session: Session, level: Level) -> bool:
    """Start the second episode: another agent, or the same player under another physics."""
    viewer, playback = session.viewer, session.playback
    other = viewer.other_physics
    if other:
        viewer.rival.start(
            level, other, playback.casting, player=other, mirror=lambda: playback.actions
        )
    else:
        casting, summary = viewer.casting("b"), viewer.slots["b"].summary
        if casting is None or summary is None:
            return False
        viewer.rival.start(level, playback.played_under, casting, player=summary.name)
    viewer.compared_episode = playback.episode
    return True


_UNKNOWN: Final = "Not known for this moment: only the places of the shapes are kept of it."


def _ask_why(session: Session) -> None:
    """Ask agent A about the moment on show, where something of it is to be drawn."""
    viewer, playback = session.viewer, session.playback
    summary = viewer.slots["a"].summary
    wanted = [name for name in OVERLAYS if name in session.settings.agent_overlay]
    level = playback.level if playback.active else session.document.level
    if not wanted or summary is None or not summary.parameters or level is None:
        viewer.reasons.forget()
        return
    if not level.bodies or not session.view.settled:
        return
    snapshot = playback.snapshot if playback.active else None
    if snapshot is not None and snapshot.state is None:
        viewer.reasons.forget()
        viewer.reasons.error = _UNKNOWN
        return
    body = _asked_body(session, level) if "places" in wanted else None
    viewer.reasons.ask(level, snapshot, summary.ref, playback.played_under, body)


def _asked_body(session: Session, level: Level) -> int | None:
    """Return the body whose path is shown: pulled at, chosen, or else the green one."""
    viewer = session.viewer
    if session.hands.pull is not None:
        viewer.asked_body = session.hands.pull.body
    free = [body.id for body in level.bodies if not body.fixed]
    chosen = [one for one in session.selection if one in free]
    if session.editing and chosen:
        return chosen[0]
    if viewer.asked_body in free:
        return viewer.asked_body
    green = [body.id for body in level.bodies if body.role == "green" and body.id in free]
    return next(iter([*green, *free]), None)


def _look(session: Session) -> None:
    """Ask for what the agent sees of the moment on show, one moment at a time."""
    viewer, playback = session.viewer, session.playback
    level = playback.level if playback.active else session.document.level
    snapshot = playback.snapshot if playback.active else None
    if level is None:
        return
    if snapshot is not None and snapshot.state is None:
        viewer.eye = viewer.eye_of = None
        viewer.eye_error = _UNKNOWN
        return
    summary = viewer.slots["a"].summary
    moment = snapshot if snapshot is not None else level
    if viewer.eye_pending or (viewer.eye_of is moment and viewer.eye_agent is summary):
        return
    viewer.eye_pending = True
    viewer.eye_of, viewer.eye_agent = moment, summary
    request = Observe(
        level=level,
        state=snapshot.state if snapshot is not None else None,
        agent=summary.ref if summary is not None else None,
    )
    session.worker.submit(request, title="Looking", done=functools.partial(_looked, session))


def _looked(session: Session, job: Job) -> None:
    viewer = session.viewer
    viewer.eye_pending = False
    if viewer.eye_of is None:
        return  # Another moment is on show by now, of which nothing is known.
    if job.state is JobState.DONE:
        viewer.eye, viewer.eye_error = job.result, ""
        viewer.eye_stamp += 1
    elif job.state is JobState.FAILED:
        viewer.eye_error = job.error
