"""Changing a level in the middle of an episode."""

from editor.documents.commands.level import ReplaceLevel, TakePoses
from editor.play.mode import Mode
from editor.play.moment import Moment, moment_of
from editor.session import Session
from kinetix.errors import CommandError


def can_change(session: Session) -> bool:
    """Return whether an episode of one's own stands still and can go on."""
    playback = session.playback
    shown = playback.snapshot
    still = playback.mode is Mode.PAUSED and not playback.waiting
    return still and shown is not None and shown.outcome is None


def change(session: Session) -> None:
    """Turn the paused episode into a level that can be edited, with undo and all tools."""
    playback = session.playback
    level, snapshot = playback.level, playback.snapshot
    if not can_change(session) or level is None or snapshot is None:
        raise CommandError("Pause the episode first (Space): then its level can be changed.")
    selection = session.selection
    before = session.tab.moment
    if before is None:
        started = moment_of(level, snapshot, playback.casting, player=playback.player)
        started.document.locked = session.document.locked
        started.document.hidden = session.document.hidden
        session.tab.moment = started
    else:
        before.document.commit(TakePoses(poses=snapshot, label="Play on"), time=session.time)
        before.document.mark_saved()
        before.snapshot = snapshot
    session.hands.pull = None
    playback.suspend()
    session.selection = selection


def play_on(session: Session, moment: Moment) -> None:
    """Go on with the episode; what was changed holds from here on."""
    playback = session.playback
    session.driver.cancel()
    if playback.suspended and not moment.changed:
        session.tab.moment = None
        playback.go_on()
        return
    playback.play_from(moment.document.level, moment.snapshot, moment.casting, player=moment.player)
    session.viewer.compared_episode = playback.episode


def has_moment(session: Session) -> bool:
    """Return whether a paused episode is being changed."""
    return session.editing and session.tab.moment is not None


def keep(session: Session) -> None:
    """Let the level start as it stands now: one edit of the level, which can be undone."""
    moment = _moment(session)
    session.driver.cancel()
    level = moment.document.level
    session.leave_moment()
    document = session.document
    label = f"Start from {moment.begin}"
    outcome = document.commit(
        ReplaceLevel(level=level.replace(name=document.level.name), label=label),
        time=session.time,
    )
    for notice in outcome.notices:
        session.toast(notice)
    session.autosaves.keep(document)
    session.toast(f"The level starts from {moment.begin} now.", "success", action="edit.undo")


def drop(session: Session) -> None:
    """Forget what was changed: back to the paused episode, or to the level where it is over."""
    moment, playback = _moment(session), session.playback
    session.driver.cancel()
    session.tab.moment = None
    if playback.suspended:
        playback.resume()
    if moment.changed:
        session.toast(f"The changes from {moment.begin} were dropped.")


def _moment(session: Session) -> Moment:
    moment = session.tab.moment
    if moment is None:
        raise CommandError("No paused episode is being changed.")
    return moment
