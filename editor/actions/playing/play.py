"""Actions of the Run menu: play, pause, step, reset, stop, edit from here."""

from editor.actions.playing import moment, solution
from editor.actions.watching import agents
from editor.documents.commands.level import TakePoses
from editor.documents.document import Document
from editor.gallery.results import HUMAN
from editor.play.mode import Mode
from editor.play.win import Win
from editor.session import Session
from kinetix.errors import CommandError
from kinetix.level.codec import level_hash
from kinetix.level.model import Level
from kinetix.level.sizes import outgrown_capacity
from kinetix.wording import plural


def play(session: Session) -> None:
    """Play the level by hand, or go on with a paused episode that was changed."""
    if session.tab.moment is not None:
        moment.play_on(session, session.tab.moment)
        return
    _refuse_outgrown(session.document.level)
    session.leave_play()
    session.messages.hush()
    session.autosaves.keep(session.document)
    session.playback.play(session.document.level)


def _refuse_outgrown(level: Level) -> None:
    """Refuse a level that does not fit its size, before anything is compiled for it.

    Raises:
        CommandError: The level does not fit its size.
    """
    if outgrown_capacity(level) is not None:
        raise CommandError(
            "The level does not fit its size: the Problems panel says what is too much, and "
            "mends it."
        )


def pause(session: Session) -> None:
    """Pause or continue; restart after the end; pause or play a replay."""
    if session.mode is Mode.ENDED:
        reset(session)
    else:
        session.playback.pause()


def note_end(session: Session) -> None:
    """Note the end of an episode: a win by hand is offered, and the first end is a result."""
    playback = session.playback
    if playback.mode is not Mode.ENDED or playback.snapshot is session.last_end.snapshot:
        return
    session.last_end.snapshot = playback.snapshot
    win = Win.of(playback)
    if win is not None:
        session.last_end.win = win
        if win.level.solution is None:
            _offer_to_keep(session)
    if playback.episode != session.last_end.episode:
        session.last_end.episode = playback.episode
        _keep_result(session)


def _keep_result(session: Session) -> None:
    """Keep how an episode of the user's own ended; pulled bodies and agents do not count."""
    playback = session.playback
    if playback.casting is None and not playback.perturbed and playback.level is not None:
        won = playback.outcome == "won"
        session.results.add_episode(HUMAN, level_hash(playback.level), won=won)


def _offer_to_keep(session: Session) -> None:
    """Offer the win on show as the level's solution, also when the next episode has begun."""
    steps = plural(session.playback.step_count, "step")
    session.messages.withdraw("level.keep_solution")
    session.messages.toast(
        f"Won in {steps}: use this as the level's solution?",
        "success",
        action="level.keep_solution",
        offered=lambda: solution.can_keep(session),
    )


def step(session: Session) -> None:
    """One environment step, with what the held keys or the agent drive."""
    session.playback.step(agents.action_now(session), session.hands.pull)


def step_back(session: Session) -> None:
    """Go back by one environment step."""
    session.playback.step_back()


def slower(session: Session) -> None:
    """Halve the speed."""
    session.playback.slower()


def faster(session: Session) -> None:
    """Double the speed."""
    session.playback.faster()


def reset(session: Session) -> None:
    """The episode from its start, with the newest parameters of the agent that plays."""
    agents.refresh_cast(session)
    session.playback.reset()


def stop(session: Session) -> None:
    """Go back to Edit."""
    session.leave_play()


def has_state(session: Session) -> bool:
    """Return whether there is a simulated state to take over."""
    return session.playback.active and session.playback.snapshot is not None


def edit_from_here(session: Session) -> None:
    """A new document that starts where the simulation is now."""
    snapshot, level = session.playback.snapshot, session.playback.level
    if snapshot is None or level is None:
        raise CommandError("Play first: there is no simulated state to edit from.")
    document = Document(level)
    document.commit(TakePoses(poses=snapshot), time=session.time)
    document.mark_unsaved()
    camera = session.camera
    session.open_tab(document)
    session.camera = camera
