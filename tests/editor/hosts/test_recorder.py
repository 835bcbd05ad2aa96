"""Recorded input, played again, gives the same level."""

import json

import pytest

from editor.base.events import (
    LEFT,
    DropEvent,
    FocusEvent,
    KeyEvent,
    PadEvent,
    PinchEvent,
    Pointer,
    PointerEvent,
    QuitEvent,
    TextEvent,
    WheelEvent,
)
from editor.base.settings import Settings
from editor.hosts.headless import HeadlessHost
from editor.hosts.recorder import Recorder
from editor.hosts.replay import Replayer
from editor.session import Session
from kinetix.errors import KinetixError
from kinetix.level.codec import save_level
from tests.editor.core.helpers import FakeSimulator, a_level
from tests.editor.gui.conftest import day, make_gui  # noqa: F401 - fixtures

LOOK = ((1280, 800), 1.0)


def a_session():
    return Session(settings=Settings(), simulator=FakeSimulator())


def test_a_recording_of_manual_use_gives_the_same_document(make_gui, tmp_path):  # noqa: F811
    script = tmp_path / "events.jsonl"
    gui = make_gui(session=a_session())
    gui.host.recorder = Recorder(gui.session, script)
    gui.key("r")
    gui.drag((1.0, 1.0), (2.0, 1.5))
    gui.key("c")
    gui.frames(20)
    gui.drag((3.0, 3.0), (3.3, 3.0))
    gui.key("ctrl+d")
    gui.hold("right")
    gui.frames(60)  # the arrow repeats as long as it is down
    gui.hold("right", pressed=False)
    gui.key("ctrl+a")
    gui.key("q")
    gui.key("ctrl+z")
    gui.wheel(600, 400, 1)
    expected = gui.session.document
    assert len(expected.level.bodies) == 3
    moved = expected.level.body(3).position[0] - expected.level.body(2).position[0]
    assert moved > 0.4  # more than one step: the key did repeat

    gui = make_gui(session=a_session())
    Replayer(gui.host, script).run()
    assert gui.session.document.hash == expected.hash
    assert gui.session.document.history.undo_label == expected.history.undo_label


def pointer(kind, x, y):
    button = 0 if kind is Pointer.MOVE else LEFT
    return PointerEvent(kind=kind, world=(0, 0), screen=(x, y), button=button)


def test_what_a_window_gets_gives_the_same_again(make_gui, tmp_path):  # noqa: F811
    """The events are as hosts send them: a wheel has no place, and several come in one frame."""
    script, level = tmp_path / "events.jsonl", tmp_path / "dropped.json"
    save_level(a_level(), level)
    gui = make_gui(session=a_session())
    gui.host.recorder = Recorder(gui.session, script)
    host, place = gui.host, gui.session.camera.to_screen((1.5, 3.5))
    host.frames(5, pointer(Pointer.MOVE, *place), WheelEvent(dy=2), pointer(Pointer.MOVE, 640, 300))
    host.frames(5, WheelEvent(dy=-0.5, dx=-0.0), WheelEvent(dy=0, dx=3))
    host.frames(5, PinchEvent(factor=1.5, screen=(500, 400)))
    gui.key("r")
    gui.drag((2.0, 2.0), (2.7, 2.5))
    # The keyboard goes in the middle of a drag, and the button with it.
    gui.key("c")
    host.frames(5, pointer(Pointer.PRESS, 600, 300), pointer(Pointer.MOVE, 630, 300))
    host.frames(5, FocusEvent(focused=False))
    host.frames(5, pointer(Pointer.MOVE, 700, 350), FocusEvent(focused=True))
    drawn, camera = gui.session.document.hash, gui.session.camera
    assert len(gui.level.bodies) == 1 and not gui.session.driver.active
    host.frames(5, DropEvent(path=str(level)))
    assert gui.session.document.path == level
    host.frames(5, PadEvent(control="pad x", pressed=True), PadEvent(control="pad a", pressed=True))
    assert "pad a" in gui.session.hands.held
    gui.host.recorder = None
    gui.key("ctrl+w")  # else the file is open in another window

    gui = make_gui(session=a_session())
    Replayer(gui.host, script).run()
    assert [tab.document.path for tab in gui.session.tabs] == [None, level]
    assert gui.session.hands.held == {"pad a"}
    first = gui.session.tabs[0]
    assert (first.document.hash, first.camera) == (drawn, camera)
    assert not gui.session.driver.active


def test_the_close_button_asks_again(make_gui, tmp_path):  # noqa: F811
    script = tmp_path / "events.jsonl"
    Recorder(a_session(), script).take([QuitEvent()], 1 / 60, LOOK)
    gui = make_gui(session=a_session())
    Replayer(gui.host, script).run()
    assert gui.session.quitting


def test_the_first_frame_of_a_window_has_its_scale(day, tmp_path):  # noqa: F811
    script = tmp_path / "events.jsonl"
    session = a_session()
    host = HeadlessHost(session, size=(1200, 700), scale=1.5)
    host.recorder = Recorder(session, script)
    host.frames(1, pointer(Pointer.MOVE, 600, 350))
    session.worker.stop()
    host.close()
    told = [json.loads(line) for line in script.read_text().splitlines()]
    assert told[0] == {"do": "window", "size": [1200, 700], "scale": 1.5}


def test_half_of_a_surrogate_pair_is_left_out(tmp_path):
    script = tmp_path / "events.jsonl"
    recorder = Recorder(a_session(), script)
    recorder.take([TextEvent(text="\ud83d")], 1 / 60, LOOK)
    recorder.take([TextEvent(text="a\ud83db")], 1 / 60, LOOK)
    told = [json.loads(line) for line in script.read_text().splitlines()]
    assert [each["text"] for each in told if each["do"] == "text"] == ["ab"]


def test_only_keys_that_a_replay_knows_are_recorded(tmp_path):
    script = tmp_path / "events.jsonl"
    recorder = Recorder(a_session(), script)
    names = ("<", "alt gr", "", "audio mute", "left shift", "a")
    recorder.take([KeyEvent(key=name, pressed=True) for name in names], 1 / 60, LOOK)
    told = [json.loads(line) for line in script.read_text().splitlines()]
    assert [each["key"] for each in told if each["do"] == "key"] == ["left shift", "a"]


def test_a_replay_in_another_window_is_refused(make_gui, tmp_path):  # noqa: F811
    script = tmp_path / "events.jsonl"
    recorder = Recorder(a_session(), script)
    recorder.take([KeyEvent(key="a", pressed=True)], 1 / 60, ((900, 700), 1.5))
    gui = make_gui(session=a_session())
    with pytest.raises(KinetixError, match=r":1: .* give --size 900x700 --scale 1\.5$"):
        Replayer(gui.host, script).run()


def test_a_scale_is_taken_as_it_is_advised(make_gui, tmp_path):  # noqa: F811
    script = tmp_path / "events.jsonl"
    recorder = Recorder(a_session(), script)
    recorder.take([KeyEvent(key="a", pressed=True)], 1 / 60, ((1280, 800), 1.100000023841858))
    gui = make_gui(session=a_session(), size=(1280, 800), scale=1.1)
    Replayer(gui.host, script).run()


def test_a_window_that_was_resized_is_resized_again(make_gui, tmp_path):  # noqa: F811
    script = tmp_path / "events.jsonl"
    gui = make_gui(session=a_session(), size=(1280, 800))
    gui.host.recorder = Recorder(gui.session, script)
    gui.key("r")
    gui.drag((1.0, 1.0), (2.0, 1.5))
    gui.host.size = (900, 700)
    gui.host.ui.host_scale = 1.5
    gui.frames(20)
    gui.key("c")
    gui.drag((3.0, 3.0), (3.3, 3.0))
    expected = gui.session.document
    assert len(expected.level.bodies) == 2

    gui = make_gui(session=a_session(), size=(1280, 800))
    Replayer(gui.host, script).run()
    assert (gui.host.size, gui.host.ui.scale) == ((900, 700), 1.5)
    assert gui.session.document.hash == expected.hash


def test_a_script_resizes_the_window_wherever_it_begins_with_something_else(make_gui, tmp_path):  # noqa: F811
    script = tmp_path / "events.jsonl"
    window = {"do": "window", "size": [900, 700], "scale": 1.0}
    script.write_text("\n".join(map(json.dumps, [{"do": "wait", "frames": 2}, window])))
    gui = make_gui(session=a_session(), size=(1280, 800))
    Replayer(gui.host, script).run()
    assert gui.host.size == (900, 700)
    script.write_text(json.dumps(window | {"size": [1280, 800]}))
    with pytest.raises(KinetixError, match=":1: recorded in another window: give --size 1280x800"):
        Replayer(gui.host, script).run()


@pytest.mark.parametrize("size, scale", [([1e9, 5], 1), ([0, 5], 1), (["a", 5], 1), ([5, 5], 99)])
def test_a_later_window_that_cannot_be_is_refused(make_gui, tmp_path, size, scale):  # noqa: F811
    script = tmp_path / "events.jsonl"
    gui = make_gui(session=a_session(), size=(1280, 800))
    lines = [{"size": [1280, 800], "scale": gui.host.ui.scale}, {"size": size, "scale": scale}]
    script.write_text("\n".join(json.dumps({"do": "window", **line}) for line in lines))
    with pytest.raises(KinetixError, match=r":2: (size|scale) is .*: expected"):
        Replayer(gui.host, script).run()


def test_open_files_and_pauses_stand_in_the_script(make_gui, tmp_path):  # noqa: F811
    script = tmp_path / "events.jsonl"
    gui = make_gui(session=a_session())
    gui.open("s/goalkeeper")
    gui.host.recorder = Recorder(gui.session, script)
    gui.frames(30)
    gui.move(500, 400)
    gui.hold("a")
    gui.lose_focus()
    told = [json.loads(line) for line in script.read_text().splitlines()]
    assert told[0]["do"] == "open"
    assert told[0]["file"].endswith("goalkeeper.json")
    assert told[1] == {"do": "window", "size": list(gui.host.size), "scale": gui.host.ui.scale}
    assert told[2] == {"do": "wait", "frames": 29}
    assert told[3] == {"do": "move", "at": [500, 400]}
    assert told[4:] == [
        {"do": "key", "key": "a", "pressed": True},
        {"do": "focus", "focused": False},
    ]


def test_a_script_that_cannot_be_written_is_refused_and_ends_no_app(tmp_path):
    with pytest.raises(KinetixError, match="No such file"):
        Recorder(a_session(), tmp_path / "nowhere" / "events.jsonl")
    script = tmp_path / "events.jsonl"
    session = a_session()
    recorder = Recorder(session, script)
    script.unlink()
    script.mkdir()
    for _ in range(2):
        recorder.take([TextEvent(text="a")], 0.1, LOOK)
    assert ["the recording ends" in toast.text for toast in session.toasts] == [True]


def test_a_file_that_is_no_script_is_refused_and_stays(tmp_path):
    level = tmp_path / "mine.json"
    save_level(a_level(), level)
    before = level.read_bytes()
    with pytest.raises(KinetixError, match=r"mine\.json: exists and is not a recorded script"):
        Recorder(a_session(), level)
    assert level.read_bytes() == before
    picture = tmp_path / "picture.png"
    picture.write_bytes(b"\x89PNG\xff")
    with pytest.raises(KinetixError):
        Recorder(a_session(), picture)
    assert picture.read_bytes() == b"\x89PNG\xff"


def test_an_earlier_script_stays_as_a_backup(tmp_path):
    script = tmp_path / "events.jsonl"
    for name in "ab":
        recorder = Recorder(a_session(), script)
        recorder.take([KeyEvent(key=name, pressed=True)], 1 / 60, LOOK)
    assert '"a"' in script.with_name("events.jsonl.bak").read_text()
    assert '"b"' in script.read_text()
