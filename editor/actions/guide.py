"""The guided first level: ten steps on the real editor, each done by doing it."""

import dataclasses
from collections.abc import Callable
from typing import Final

from editor.actions.files import file
from editor.play.mode import Mode
from editor.session import Session
from kinetix.level.model import Circle

CLOSED: Final = -1
"""Nobody is guided."""
OFFERED: Final = -2
"""The app has never been started before: the guide waits to be asked for."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Step:
    """One thing to do, and how to see that it is done."""

    title: str
    words: str
    done: Callable[[Session], bool]
    action: str = ""
    """The action whose keys the card shows."""


def _boxes(session: Session) -> int:
    return sum(not isinstance(b.shape, Circle) for b in session.document.level.bodies)


def _circles(session: Session) -> int:
    return sum(isinstance(b.shape, Circle) for b in session.document.level.bodies)


def _joints(session: Session) -> int:
    return len(session.document.level.joints)


def _has(session: Session, role: str) -> bool:
    return any(body.role == role for body in session.document.level.bodies)


def _saved(session: Session) -> bool:
    return session.document.path is not None and not session.document.dirty


STEPS: Final = (
    Step(
        title="Draw the board",
        words="Choose the rectangle and drag one above the floor, on the left.",
        action="tool.rectangle",
        done=lambda session: _boxes(session) >= 1,
    ),
    Step(
        title="Draw a wheel",
        words="Choose the circle. Drag from the centre, at one end of the board, so that they "
        "overlap.",
        action="tool.circle",
        done=lambda session: _circles(session) >= 1,
    ),
    Step(
        title="Draw the other wheel",
        words="The same at the other end. Ctrl+Z takes back what went wrong.",
        action="tool.circle",
        done=lambda session: _circles(session) >= 2,
    ),
    Step(
        title="Join a wheel to the board",
        words="Choose the joint and click in the middle of a wheel: it becomes a hinge with a "
        "motor.",
        action="tool.joint",
        done=lambda session: _joints(session) >= 1,
    ),
    Step(
        title="Join the other wheel",
        words="The caps on the joints are the keys that will drive them.",
        action="tool.joint",
        done=lambda session: _joints(session) >= 2,
    ),
    Step(
        title="Make the board green",
        words="Click the board. In the Inspector, choose the role Green: green has to arrive.",
        action="tool.select",
        done=lambda session: _has(session, "green"),
    ),
    Step(
        title="Draw the goal",
        words="A circle on the right; then the role Blue. Green has to touch blue.",
        action="tool.circle",
        done=lambda session: _has(session, "blue") and _has(session, "green"),
    ),
    Step(
        title="Play",
        words="Nothing that happens in Play changes the level. Esc goes back to editing.",
        action="run.play_human",
        done=lambda session: session.mode in (Mode.PLAYING, Mode.PAUSED, Mode.ENDED),
    ),
    Step(
        title="Win",
        words="Drive with Left and Right until the board touches the goal. Too hard? Esc, move the "
        "goal nearer, play again.",
        done=lambda session: session.playback.outcome == "won",
    ),
    Step(
        title="Save",
        words="Esc, then save under a name of your own. The gallery shows it from then on.",
        action="file.save",
        done=_saved,
    ),
)


def current(session: Session) -> Step | None:
    """Return the step that is to be done; None where nobody is guided or all is done."""
    number = session.settings.guide_step
    return STEPS[number] if 0 <= number < len(STEPS) else None


def start(session: Session) -> None:
    """Restart the guide, in an empty level."""
    session.gallery.open = False
    if session.document.level.bodies or session.document.path is not None:
        file.new(session)
    session.settings.guide_step = 0


def close(session: Session) -> None:
    """Close the guide; Help ▸ Guided First Level restarts it."""
    session.settings.guide_step = CLOSED


def skip(session: Session) -> None:
    """Take a step as done."""
    session.settings.guide_step += 1


def follow(session: Session) -> None:
    """Go on when what is to be done has been done, by hand: a level as it was opened counts not."""
    step = current(session)
    if step is None or session.gallery.open:
        return
    built = session.document.history.undo_label is not None
    if (built or not step.action.startswith("tool.")) and step.done(session):
        skip(session)
        session.keeper.save()


def offer(session: Session) -> None:
    """Offer the guide at the first start of the app; a finished one is closed."""
    settings = session.settings
    if settings.guide_step >= len(STEPS):
        close(session)
    # The layout is kept at every end, so that without one this start is the first.
    first = not settings.layout and not settings.recents
    if first and settings.guide_step == CLOSED:
        settings.guide_step = OFFERED
