"""A win is shown by more than its word, to a person who wants it."""

import pytest

from editor.toolkit.widgets import px
from editor.window import canvas, play_side
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


@pytest.mark.parametrize("size", [(1280, 800), (1024, 640)])
def test_what_is_said_of_the_end_stands_in_the_arena_where_there_is_no_room_beside(
    make_gui, monkeypatch, size
):
    session = a_session()
    simulator = FakeSimulator()
    simulator.ends_at, simulator.ends = 5, "won"
    session.playback.simulator = simulator
    gui = make_gui(session=session, size=size)
    gui.frames(40)
    plates = []
    underlay = play_side._Column.underlay

    def noted(column, top):
        plates.append((column.x - px(8), top - px(8), *(at + px(8) for at in column.reach)))
        underlay(column, top)

    monkeypatch.setattr(play_side._Column, "underlay", noted)
    gui.key("space")
    gui.frames(30)
    gui.key("tab")
    gui.frames(40)
    assert session.playback.outcome == "won"
    left, top = gui.screen(0.0, 5.0)
    right, bottom = gui.screen(5.0, 0.0)
    plate = plates[-1]
    assert left <= plate[0] and top <= plate[1] and plate[2] <= right and plate[3] <= bottom
