"""An exception at the top of a frame: told, reported, the work saved aside, the window goes on."""

import signal
from pathlib import Path

import pytest
from imgui_bundle import imgui

from editor.documents import recovery
from editor.documents.commands.group import Move
from editor.session import Session
from editor.worker.jobs import Worker
from kinetix.failures import Terminated, terminable
from tests.editor.core.helpers import a_level
from tests.editor.days import refuse


@pytest.fixture
def gui(make_gui):
    gui = make_gui(session=Session(worker=Worker(perform=refuse), level=a_level()))
    gui.host.endures = True
    gui.frames(40)
    yield gui
    gui.session.autosaves.end()


def reports(tmp_path: Path):
    return sorted(tmp_path.glob("state/kinetix-editor/crashes/*.txt"))


def copies_of(session):
    return sorted(session.autosaves.folder.glob("*[0-9].json"))


def fails(*_):
    imgui.begin("left open")
    imgui.begin_group()
    raise ZeroDivisionError("on purpose")


@pytest.mark.parametrize("part", ["workplace.draw", "_bars"])
def test_the_window_goes_on_and_the_work_is_aside(gui, tmp_path, monkeypatch, part):
    session = gui.session
    session.execute(Move(ids=(3,), shift=(0.25, 0.0)))
    session.queue("edit.select_all")
    gui.frames(2)
    with monkeypatch.context() as patched:
        *inner, name = part.split(".")
        owner = getattr(gui.host.ui, inner[0]) if inner else gui.host.ui
        patched.setattr(owner, name, fails)
        gui.frames(5)
    gui.frames(10)
    assert gui.shows("outliner.filter")
    gui.key("c")
    assert session.tool.id == "circle"
    (report,) = reports(tmp_path)
    (toast,) = [toast for toast in session.toasts if "on purpose" in toast.text]
    assert report.name in toast.text
    text = report.read_text()
    assert "ZeroDivisionError: on purpose" in text
    assert "edit.select_all" in text and "Move" in text
    assert str(tmp_path) not in text and str(Path.home()) + "/" not in text
    copies = copies_of(session)
    assert [recovery._read(copy).level for copy in copies] == [session.document.level]


def fails_in_a_table(*_):
    imgui.begin_child("left open", (100, 100))
    imgui.begin_table("left open", 2, imgui.TableFlags_.scroll_y.value, (50, 50))
    imgui.table_next_row()
    imgui.push_id("left open")
    raise ZeroDivisionError("on purpose")


def test_a_panel_that_fails_inside_a_table_leaves_the_rest_of_the_frame_alone(
    gui, tmp_path, monkeypatch
):
    gui.bring("history")
    gui.host.endures = False  # No frame may fail.
    with monkeypatch.context() as patched:
        panel = next(panel for panel in gui.host.ui.workplace.panels if panel.id == "history")
        patched.setattr(panel, "draw", fails_in_a_table)
        gui.frames(5)
        assert gui.shows("menu.agent")
    gui.frames(5)
    assert len(reports(tmp_path)) == 1


def test_an_event_that_fails_is_told(gui, tmp_path, monkeypatch):
    with monkeypatch.context() as patched:
        patched.setattr(gui.host.ui, "notice", fails)
        gui.lose_focus()
    gui.frames(5)
    assert len(reports(tmp_path)) == 1
    assert gui.shows("outliner.filter")


def test_different_faults_have_reports_of_their_own(gui, tmp_path):
    for fault in (KeyError("a"), ValueError("b")):
        for _ in range(3):
            with gui.session.guard():
                raise fault
    assert len(reports(tmp_path)) == 2


def test_a_window_that_only_fails_ends_with_the_work_aside(gui, monkeypatch):
    gui.session.execute(Move(ids=(3,), shift=(0.25, 0.0)))
    monkeypatch.setattr(gui.host.ui, "frame", lambda dt: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        gui.frames(1000)
    imgui.render()
    assert len(copies_of(gui.session)) == 1


def test_a_script_ends_with_the_first_failing_frame(gui, monkeypatch):
    gui.host.endures = False
    monkeypatch.setattr(gui.host.ui, "frame", lambda dt: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        gui.frames(1)
    imgui.render()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_waits_for_the_end_of_a_frame(gui, monkeypatch, number):
    draw, drawn = gui.host.ui.workplace.draw, []

    def told(*words: object) -> None:
        signal.raise_signal(number)
        draw(*words)
        drawn.append(imgui.get_frame_count())

    monkeypatch.setattr(gui.host.ui.workplace, "draw", told)
    with terminable(), pytest.raises((KeyboardInterrupt, Terminated)):
        gui.frames(5)
    assert len(drawn) == 1
    monkeypatch.undo()
    gui.frames(5)


def test_a_second_signal_does_not_wait_for_a_frame(gui, monkeypatch):
    def hangs(*_: object) -> None:
        for _ in range(2):
            signal.raise_signal(signal.SIGINT)
        pytest.fail("it went on")

    monkeypatch.setattr(gui.host.ui.workplace, "draw", hangs)
    with pytest.raises(KeyboardInterrupt):
        gui.frames(1)
