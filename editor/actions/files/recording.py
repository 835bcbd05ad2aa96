"""Recording: what is on show becomes films, until the same action ends it."""

from collections.abc import Callable

from editor.actions.files import export
from editor.base.prompts import Choice, Question
from editor.play.film_recording import Recording
from editor.session import Session
from kinetix.errors import CommandError, LevelError
from kinetix.files.atomic import check_target


def start_or_end(session: Session) -> None:
    """Start filming what is played; again: write the film."""
    if session.films.recording is None:
        session.films.recording = Recording.of(session.playback)
        session.toast("Recording: play, then press Ctrl+Shift+R again.")
        return
    try:
        end(session)
    except LevelError as error:
        ask_to_drop(
            session,
            error,
            title="Drop the film?",
            drop=Choice(id="drop", label="Drop the Film"),
            keep=Choice(id="go_on", label="Go On Recording"),
        )


def end(session: Session) -> None:
    """Write the films of what was recorded.

    Raises:
        CommandError: Nothing was played; the recording has ended.
        LevelError: Nothing can be written there; the recording goes on.
    """
    recording = session.films.recording
    films = [] if recording is None else recording.films()
    if films:
        check_target(export.free_name(session, ".gif"))
    session.films.recording = None
    if not films:
        raise CommandError("Nothing was played while recording.")
    for level, trace in films:
        export.film(session, level, trace, export.free_name(session, ".gif"), numbered=True)


def ask_to_drop(
    session: Session,
    error: LevelError,
    *,
    title: str,
    drop: Choice,
    keep: Choice,
    then: Callable[[], None] = lambda: None,
) -> None:
    """Ask whether to drop a recording that cannot be written.

    Args:
        session: Whose recording.
        error: Why it cannot be written.
        title: Of the question.
        drop: The answer that drops it.
        keep: The answer that changes nothing.
        then: Called once it is dropped.
    """

    def answer(choice: str) -> None:
        if choice == drop.id:
            session.films.recording = None
            then()

    session.ask(
        Question(
            title=title,
            message=f"{error}\nTo keep the film, save the level in another folder.",
            choices=(drop, keep),
            default=keep.id,
            cancel=keep.id,
            answer=answer,
        )
    )


def follow(session: Session) -> None:
    """Let a frame pass: what is on show comes into the film."""
    if session.films.recording is not None:
        session.films.recording.follow(session.playback)
