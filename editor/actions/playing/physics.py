"""Choice of the physics: the preset of the next episode, and another one beside it."""

from editor.base.prompts import Choice, MenuQuestion
from editor.play.mode import Mode
from editor.session import Session
from kinetix.engine.names import PHYSICS

NONE = "none"


def choose(session: Session, name: str) -> None:
    """Use another preset from the next episode on; a running episode restarts."""
    session.settings.physics = name
    session.playback.choose_physics(name)
    _again(session)


def comparing(session: Session) -> bool:
    """Return whether the same is played under two physics side by side."""
    return bool(session.viewer.other_physics)


def compare_with(session: Session, name: str) -> None:
    """Play the same under another physics beside it; an empty name: no more."""
    session.viewer.other_physics = name
    session.viewer.compared_episode = -1
    _again(session)


def ask_other(session: Session) -> None:
    """Choose the second physics from a list."""

    def answer(choice: str | None) -> None:
        if choice is not None:
            compare_with(session, "" if choice == NONE else choice)

    own = session.playback.next_physics
    choices = [Choice(id=name, label=name) for name in PHYSICS if name != own]
    if comparing(session):
        choices.append(Choice(id=NONE, label="Only one physics"))
    session.ask(
        MenuQuestion(
            title=f"Beside {own}, the same under", choices=tuple(choices), at=None, answer=answer
        )
    )


def _again(session: Session) -> None:
    if session.mode in (Mode.PLAYING, Mode.PAUSED, Mode.ENDED):
        session.playback.reset()
