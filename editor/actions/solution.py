"""A level's recorded solution: keep a win as one, see it played."""

import functools
import itertools
from typing import Any

from editor.documents.commands.level import KeepSolution
from editor.documents.document import Document
from editor.play.mode import Mode
from editor.session import Session
from editor.worker.jobs import Job, JobState
from editor.worker.requests import PlaySolution
from kinetix.level.model import Level, Solution
from kinetix.wording import plural

PLAYER = "recorded solution"
"""Name of the recorded solution on the screen."""
_TOO_CLOSE = (
    "Not kept: played again, these keys just miss. It was won by a hair, and the level's own step "
    "rounds differently from the one that all levels share. Win it with more room to spare."
)


def can_keep(session: Session) -> bool:
    """Return whether the episode shown was won by a person from the start, with keys alone."""
    playback, trace = session.playback, session.playback.trace
    won = playback.mode is Mode.ENDED and playback.outcome == "won"
    by_hand = playback.casting is None and not playback.perturbed
    return won and by_hand and trace is not None and trace.snapshots[0].step == 0


def keep(session: Session) -> None:
    """Record what was played in the level, as one edit.

    A solution has to win in the step that commands, level sets and other levels of the size use.
    What was played in the step for this level alone is therefore played again in that one first.
    """
    trace, skip = session.playback.trace, session.playback.frame_skip
    assert trace is not None
    runs = tuple((len(list(same)), action) for action, same in itertools.groupby(trace.actions))
    actions: Any = runs
    solution = Solution(physics=trace.physics, frame_skip=skip, actions=actions)
    session.leave_play()
    if not trace.snapshots[-1].tailored:
        _record(session, solution)
        return
    session.expected = session.worker.submit(
        PlaySolution(level=session.document.level.replace(solution=solution)),
        title="Playing the solution again",
        urgent=True,
        done=functools.partial(_judged, session, session.document, session.document.level),
    )


def _judged(session: Session, document: Document, level: Level, job: Job) -> None:
    """Keep a solution that was played again and has won; another level is left alone."""
    if job.state is JobState.FAILED:
        session.toast(f"The solution was not kept: {job.error}", "error")
    elif job.state is JobState.DONE and session.document is document and document.level == level:
        if job.result.trace.snapshots[-1].outcome == "won":
            session.leave_play()
            _record(session, job.result.level.solution)
        else:
            session.complain(_TOO_CLOSE)


def _record(session: Session, solution: Solution) -> None:
    session.messages.withdraw("level.keep_solution")
    if session.execute(KeepSolution(solution=solution)).changed:
        steps = len(list(solution.unrolled()))
        session.toast(f"Kept as the solution: {plural(steps, 'step')}.", action="edit.undo")


def has_solution(session: Session) -> bool:
    """Return whether the level in front has one."""
    return session.document.level.solution is not None


def play(session: Session) -> None:
    """Show the recorded solution on the timeline."""
    level = session.document.level
    session.expected = session.worker.submit(
        PlaySolution(level=level),
        title="Playing the solution",
        urgent=True,
        done=functools.partial(_played, session),
    )


def _played(session: Session, job: Job) -> None:
    if job.state is JobState.FAILED:
        session.toast(job.error, "error")
    elif job.state is JobState.DONE and session.document.level == job.result.level:
        session.leave_play()
        session.gallery.open = False
        session.playback.replay(job.result.trace, job.result.level, player=PLAYER)
        session.playback.running = True
        session.view.front = "timeline"
