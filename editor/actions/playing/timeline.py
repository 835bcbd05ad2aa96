"""Going back in an episode: play on from a moment, loop a part of it."""

from editor.session import Session


def start_here(session: Session) -> None:
    """Play on from the moment on show."""
    playback = session.playback
    playback.branch()
    session.viewer.compared_episode = playback.episode


def can_start_here(session: Session) -> bool:
    """Return whether the episode can be played on from the moment on show."""
    return session.playback.can_branch


def loop_from(session: Session) -> None:
    """Begin the loop at the moment on show."""
    _set_loop(session, first=session.playback.replay_index)


def loop_to(session: Session) -> None:
    """End the loop at the moment on show."""
    _set_loop(session, last=session.playback.replay_index)


def _set_loop(session: Session, *, first: int | None = None, last: int | None = None) -> None:
    playback = session.playback
    playback.look_back()
    old = playback.loop or (0, len(playback.moments) - 1)
    low = old[0] if first is None else first
    high = old[1] if last is None else last
    playback.loop = (low, high) if low < high else None


def clear_loop(session: Session) -> None:
    """Show the whole episode again."""
    session.playback.loop = None
