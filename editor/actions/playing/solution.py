"""A level's recorded solution: keep a win as one, see it played."""

import functools

from editor.documents.commands.level import KeepSolution
from editor.documents.document import Document, same_simulation
from editor.play.mode import Mode
from editor.play.win import Win
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
    """Return whether a person has won the level in front from the start, with keys alone."""
    return _win(session) is not None


def _win(session: Session) -> Win | None:
    """Return the win on show, or else the last one, if the level in front still plays like it."""
    playback = session.playback
    on_show = playback.mode is Mode.ENDED and playback.outcome == "won"
    win = Win.of(playback) if on_show else session.last_end.win
    return win if win and same_simulation(win.level, session.document.level) else None


def keep(session: Session) -> None:
    """Record what was played in the level, as one edit.

    A solution has to win in the step that commands, level sets and other levels of the size use.
    What was played in the step for this level alone is therefore played again in that one first.
    """
    win = _win(session)
    assert win is not None
    session.last_end.win = None
    session.messages.withdraw("level.keep_solution")
    session.leave_play()
    if not win.tailored:
        _record(session, win.solution)
        return
    session.expected = session.worker.submit(
        PlaySolution(level=session.document.level.replace(solution=win.solution)),
        title="Playing the solution again",
        urgent=True,
        done=functools.partial(_judged, session, session.document, session.document.level, win),
    )


def _judged(session: Session, document: Document, level: Level, win: Win, job: Job) -> None:
    """Keep a solution that was played again and has won.

    Where nobody waits for it any more, or the level is another one by now, nothing is touched, and
    the win can be kept as before.
    """
    awaited = session.take_expected(job) and job.state is JobState.DONE
    if job.state is JobState.FAILED:
        session.toast(f"The solution was not kept: {job.error}", "error")
    elif not awaited or session.document is not document or document.level != level:
        session.last_end.win = session.last_end.win or win
    elif job.result.trace.snapshots[-1].outcome == "won":
        session.leave_play()
        _record(session, job.result.level.solution)
    else:
        session.complain(_TOO_CLOSE)


def _record(session: Session, solution: Solution) -> None:
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
    awaited = session.take_expected(job) and job.state is JobState.DONE
    if job.state is JobState.FAILED:
        session.toast(job.error, "error")
    elif awaited and session.document.level == job.result.level:
        session.leave_play()
        session.gallery.open = False
        session.playback.replay(job.result.trace, job.result.level, player=PLAYER)
        session.playback.running = True
        session.view.front = "timeline"
