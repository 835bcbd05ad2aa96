"""A window without a window: the whole app under headless imgui, driven by names of widgets."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from imgui_bundle import imgui

from editor.actions.files import file
from editor.base import language
from editor.base.events import FocusEvent, KeyEvent, Pointer, PointerEvent, TextEvent, WheelEvent
from editor.hosts.headless import HeadlessHost
from editor.session import Session
from editor.toolkit.widgets import Probe
from editor.worker.jobs import Worker
from kinetix.level.model import Level
from tests.editor import days
from tests.editor.gui.browsing import gallery, mine
from tests.editor.gui.viewing import viewer_gui, with_agent

__all__ = ["gallery", "mine", "viewer_gui", "with_agent"]


@pytest.fixture(autouse=True)
def english() -> Iterator[None]:
    """The language is the process's: tests that change it leave English behind."""
    yield
    language.use(language.ENGLISH)


class Gui:
    """Clicks, types and drags as a person would, one kind of input a frame."""

    def __init__(self, session: Session, **options: object) -> None:
        self.session = session
        self.host = HeadlessHost(session, **options)
        self.host.frames(8)

    @property
    def level(self) -> Level:
        return self.session.document.level

    def frames(self, count: int = 1) -> None:
        self.host.frames(count)

    def probe(self, name: str) -> Probe:
        found = self.session.probe.get(name)
        assert isinstance(found, Probe), (
            f"{name} is not on the screen: {sorted(self.session.probe)}"
        )
        return found

    def shows(self, name: str) -> bool:
        return name in self.session.probe

    def move(self, x: float, y: float) -> None:
        event = PointerEvent(kind=Pointer.MOVE, world=(0, 0), screen=(x, y), button=0)
        self.host.frames(1, event)
        self.one_thing_under_the_pointer()

    def one_thing_under_the_pointer(self) -> None:
        """Fail where two things have one id: Dear ImGui gives a click to neither or to both."""
        context = imgui.get_current_context()
        assert context.hovered_id_previous_frame_item_count <= 1, "two things with one id"

    def button(self, x: float, y: float, *, pressed: bool, button: int = 1) -> None:
        kind = Pointer.PRESS if pressed else Pointer.RELEASE
        event = PointerEvent(kind=kind, world=(0, 0), screen=(x, y), button=button)
        self.host.frames(1, event)

    def click_at(self, x: float, y: float, *, button: int = 1) -> None:
        self.move(x, y)
        self.button(x, y, pressed=True, button=button)
        self.one_thing_under_the_pointer()
        self.button(x, y, pressed=False, button=button)
        self.frames(2)

    def click(self, name: str) -> None:
        self.click_at(*self.probe(name).centre)

    def screen(self, x: float, y: float) -> tuple[float, float]:
        return self.session.camera.to_screen((x, y))

    def click_world(self, x: float, y: float, *, button: int = 1) -> None:
        self.click_at(*self.screen(x, y), button=button)

    def drag(
        self, start: tuple[float, float], end: tuple[float, float], *, button: int = 1
    ) -> None:
        (ax, ay), (bx, by) = self.screen(*start), self.screen(*end)
        self.move(ax, ay)
        self.button(ax, ay, pressed=True, button=button)
        for k in range(1, 6):
            self.move(ax + (bx - ax) * k / 5, ay + (by - ay) * k / 5)
        self.button(bx, by, pressed=False, button=button)
        self.frames(2)

    def key(self, chord: str) -> None:
        *mods, key = chord.split("+")
        for mod in mods:
            self.host.frames(1, KeyEvent(key=f"left {mod}", pressed=True))
        self.host.frames(1, KeyEvent(key=key, pressed=True))
        self.host.frames(1, KeyEvent(key=key, pressed=False))
        for mod in mods:
            self.host.frames(1, KeyEvent(key=f"left {mod}", pressed=False))
        self.frames(2)

    def hold(self, key: str, *, pressed: bool = True) -> None:
        self.host.frames(1, KeyEvent(key=key, pressed=pressed))

    def text(self, words: str) -> None:
        self.host.frames(1, TextEvent(text=words))
        self.frames(2)

    def wheel(self, x: float, y: float, dy: float) -> None:
        self.move(x, y)
        self.host.frames(1, WheelEvent(dy=dy))  # hosts do not say where

    def lose_focus(self) -> None:
        self.host.frames(1, FocusEvent(focused=False))

    def bring(self, panel: str) -> None:
        """Bring a panel to the front; the place under the canvas opens for it."""
        self.session.view.front = panel
        self.frames(8)

    def open(self, path: Path | str) -> None:
        assert file.open_path(self.session, path), self.session.log.lines
        self.frames(4)


class Factory:
    """Makes windows; closes the last before the next (imgui has one current context)."""

    def __init__(self) -> None:
        self.current: Gui | None = None

    def __call__(
        self, *, session: Session | None = None, level: Level | None = None, **options: object
    ) -> Gui:
        self.close()
        if session is None:
            session = days.a_session(Worker(perform=days.refuse), level)
        self.current = Gui(session, **options)
        return self.current

    def close(self) -> None:
        if self.current is not None:
            self.current.session.worker.stop()
            self.current.session.library.stop()
            self.current.host.close()
            self.current = None


@pytest.fixture(params=days.DAYS)
def day(
    request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, yesterday: Path
) -> str:
    """Puts the user's folders into a temporary one: empty, or as yesterday has left them."""
    for name, value in days.folders(tmp_path).items():
        monkeypatch.setenv(name, value)
    if request.param == days.SECOND:
        days.put(yesterday, tmp_path)
    return request.param


@pytest.fixture
def make_gui(day: str) -> Iterator[Factory]:
    """Makes windows on the first and on the second day."""
    del day
    factory = Factory()
    yield factory
    factory.close()


@pytest.fixture
def gui(make_gui: Factory) -> Gui:
    """A window on an empty level."""
    return make_gui()
