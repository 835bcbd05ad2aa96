"""A win is shown by more than its word, to a person who wants it."""

import pytest

from editor.window import canvas
from tests.editor.core.helpers import FakeSimulator, a_session


@pytest.mark.parametrize(
    ("ends", "setting", "falls"),
    [
        ("won", {}, True),
        ("lost", {}, False),
        ("won", {"win_effects": False}, False),
        ("won", {"reduced_motion": True}, False),
    ],
)
def test_confetti_falls_once_over_a_win(make_gui, monkeypatch, ends, setting, falls):
    drawn = []

    def paint(draw, low, high, elapsed):
        before = draw.vtx_buffer.size()
        confetti(draw, low, high, elapsed)
        drawn.append(draw.vtx_buffer.size() - before)

    confetti = canvas.paint_confetti
    monkeypatch.setattr(canvas, "paint_confetti", paint)
    session = a_session()
    simulator = FakeSimulator()
    simulator.ends_at, simulator.ends = 5, ends
    session.playback.simulator = simulator
    for name, value in setting.items():
        setattr(session.settings, name, value)
    gui = make_gui(session=session)
    gui.frames(10)
    session.attended = True
    gui.key("space")
    gui.frames(60)
    assert session.playback.outcome == ends
    assert any(drawn) is falls
    gui.frames(120)
    assert not any(drawn[-20:])
