"""The app with software OpenGL and no display: pixels, scales, exit status."""

import json

import numpy as np
import pytest

from tests.editor.hosts.outputs import pixels

pytestmark = [pytest.mark.gl, pytest.mark.usefixtures("software_gl")]


OPEN = '{"do":"open","file":"l/rover_ridge"}'


@pytest.mark.parametrize("scale", ["1", "1.5", "2"])
def test_screens_are_drawn_at_every_scale(run_editor, script, tmp_path, scale):
    width, height = round(1280 * float(scale)), round(800 * float(scale))
    done = run_editor(
        "--offscreen",
        "--size",
        f"{width}x{height}",
        "--scale",
        scale,
        "--replay",
        str(script("tour_of_panels.jsonl", OPEN)),
    )
    assert done.returncode == 0, done.stderr
    selected = pixels(tmp_path / "selected.png")
    assert selected.shape == (height, width, 3)
    white = (selected == 255).all(axis=2).mean()
    assert 0.1 < white < 0.6, "the arena's paper is not there"
    for other in ("help", "palette", "open"):
        assert np.abs(pixels(tmp_path / f"{other}.png") - selected).mean() > 1.0
    assert json.loads((tmp_path / "state.json").read_text())["mode"] == "edit"


def test_roles_have_the_palettes_colours(run_editor, tmp_path):
    events = tmp_path / "events.jsonl"
    events.write_text(OPEN + "\n" + json.dumps({"do": "screenshot", "file": f"{tmp_path}/a.png"}))
    done = run_editor("--offscreen", "--size", "1280x800", "--replay", str(events))
    assert done.returncode == 0, done.stderr
    image = pixels(tmp_path / "a.png")
    for colour, least in (((0, 204, 0), 500), ((0, 51, 102), 500), ((80, 80, 80), 5000)):
        assert (image == colour).all(axis=2).sum() > least, colour


def test_an_event_is_seen_in_the_frame_that_takes_it(home, monkeypatch):
    for name, value in home.items():
        monkeypatch.setenv(name, value)
    from editor.actions.files import file
    from editor.base.events import Pointer, PointerEvent
    from editor.hosts.offscreen import OffscreenHost
    from editor.session import Session

    session = Session()
    host = OffscreenHost(session, size=(960, 640))
    try:
        file.open_path(session, "l/rover_ridge")
        for _ in range(4):
            host.step((), 1 / 60)
        at = tuple(map(round, session.camera.to_screen((4.75, 1.2))))
        before = host.screenshot()
        host.step([PointerEvent(kind=Pointer.MOVE, world=(0, 0), screen=at, button=0)], 1 / 60)
        press = PointerEvent(kind=Pointer.PRESS, world=(0, 0), screen=at)
        host.step([press], 1 / 60)
        assert session.selection == (8,)
        changed = np.abs(host.screenshot().astype(int) - before).max(axis=2) > 40
        x, y = map(round, session.camera.to_screen((4.62, 1.2)))
        assert changed[y - 20 : y + 20, x - 12 : x + 12].any()
    finally:
        session.worker.stop()
        host.close()


def test_slanted_edges_are_smooth(home, monkeypatch):
    for name, value in home.items():
        monkeypatch.setenv(name, value)
    from editor.hosts.offscreen import OffscreenHost
    from editor.session import Session
    from kinetix.level.model import Body, Level, Polygon

    corners = ((0.0, 0.6), (-0.6, -0.3), (0.6, -0.3))
    body = Body(id=1, shape=Polygon(vertices=corners), position=(2.5, 2.5), angle=0.3, fixed=True)
    session = Session(level=Level(name="Triangle", bodies=(body,)))
    session.settings.grid_visible = False
    host = OffscreenHost(session, size=(960, 640))
    try:
        for _ in range(12):
            host.step((), 1 / 60)
        x, y = map(round, session.camera.to_screen((2.5, 2.5)))
        grey = host.screenshot()[y - 40 : y + 40, x - 40 : x + 40].mean(axis=2)
        # White paper, black outline, dark fill: what lies between them are blended pixels.
        blended = ((grey > 100) & (grey < 235)).sum()
        assert blended > 60
    finally:
        session.worker.stop()
        host.close()


def test_a_window_that_grows_is_drawn_whole(run_editor, tmp_path):
    events = tmp_path / "events.jsonl"
    first = {"do": "window", "size": [960, 640], "scale": 1.0}
    shot = {"do": "screenshot", "file": f"{tmp_path}/a.png"}
    lines = [first, first | {"size": [1280, 800]}, {"do": "wait", "frames": 20}, shot]
    events.write_text("\n".join([OPEN, *map(json.dumps, lines)]))
    done = run_editor("--offscreen", "--size", "960x640", "--replay", str(events))
    assert done.returncode == 0, done.stderr
    events.write_text("\n".join([OPEN, json.dumps(shot | {"file": f"{tmp_path}/b.png"})]))
    done = run_editor("--offscreen", "--size", "1280x800", "--replay", str(events))
    assert done.returncode == 0, done.stderr
    grown, same = pixels(tmp_path / "a.png"), pixels(tmp_path / "b.png")
    assert grown.shape == same.shape == (800, 1280, 3)
    for part in (np.s_[:, 1000:], np.s_[700:]):
        assert grown[part].std() == pytest.approx(same[part].std(), rel=0.2)


def test_a_bad_event_is_exit_1_with_its_line(run_editor, tmp_path):
    events = tmp_path / "events.jsonl"
    events.write_text('{"do":"wait","frames":1}\n{"do":"dance"}\n')
    done = run_editor("--offscreen", "--replay", str(events))
    assert done.returncode == 1
    assert f"{events}:2: unknown event 'dance'" in done.stderr
    assert done.stdout == ""


def test_a_bad_level_is_exit_1_with_one_sentence(run_editor, tmp_path):
    level = tmp_path / "bad.json"
    level.write_text("{")
    events = tmp_path / "events.jsonl"
    events.write_text("")
    done = run_editor("--offscreen", "--replay", str(events), str(level))
    assert done.returncode == 1
    assert "bad.json" in done.stderr and "Traceback" not in done.stderr
