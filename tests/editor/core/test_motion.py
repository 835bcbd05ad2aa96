"""Motion between steps: even on the screen, exact where a step is looked at."""

import numpy as np
import pytest

from editor.play.motion import between
from editor.toolkit.appearance import COLOURS
from kinetix.render.palette import contrast
from tests.editor.core.helpers import Hand, a_session


def places(session, frames, rate=60):
    found = []
    for _ in range(frames):
        Hand(session).wait(1 / rate)
        found.append(session.scene.bodies[0].position[0])
    return np.array(found)


@pytest.mark.parametrize("rate", [60, 144])
def test_bodies_move_evenly_at_the_rate_of_the_screen(rate):
    session = a_session()
    hand = Hand(session)
    hand.key("space")
    hand.down("left")
    places(session, 40, rate)
    moves = np.diff(places(session, 60, rate))
    assert (moves > 0).all()
    assert moves.max() < 1.6 * moves.mean()


def test_what_is_paused_or_stepped_to_is_shown_as_it_is():
    session = a_session()
    hand = Hand(session)
    hand.key("space")
    hand.down("left")
    places(session, 31)
    hand.key("space")
    hand.wait()
    shown = session.scene.bodies[0].position
    assert shown == pytest.approx(tuple(session.playback.snapshot.position[0].tolist()), abs=1e-6)
    hand.key(".")
    hand.wait()
    shown = session.scene.bodies[0].position
    assert shown == pytest.approx(tuple(session.playback.snapshot.position[0].tolist()), abs=1e-6)


def test_what_is_shown_is_never_more_than_two_steps_old():
    session = a_session()
    session.playback.speed = 8.0
    Hand(session).key("space")
    for _ in range(40):
        Hand(session).wait(1 / 30)
        if session.motion.moment is not None:
            newest = session.playback.ring.snapshots[-1]
            behind = newest.step - session.motion._at
            assert 0 <= behind <= 1 + 8 * 30 / 30 * 2


def test_angles_turn_the_short_way():
    session = a_session()
    Hand(session).key("space")
    Hand(session).wait()
    snapshot = session.playback.snapshot
    import dataclasses

    a = dataclasses.replace(snapshot, angle=np.full_like(snapshot.angle, 3.1))
    b = dataclasses.replace(snapshot, angle=np.full_like(snapshot.angle, -3.1))
    assert between(a, b, 0.5).angle == pytest.approx(np.pi, abs=1e-3)


@pytest.mark.parametrize("ink", ["text", "muted", "faint"])
@pytest.mark.parametrize("ground", ["backdrop", "surface", "raised", "field"])
def test_text_has_contrast_enough(ink, ground):
    pair = ([255 * c for c in getattr(COLOURS, name)[:3]] for name in (ink, ground))
    assert contrast(*pair) >= 4.5
