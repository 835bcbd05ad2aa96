"""The same app without OpenGL and without a window: for tests."""

from collections.abc import Callable

from imgui_bundle import imgui

from editor.base import events
from editor.hosts.base import Host
from editor.hosts.renderer import NullRenderer
from editor.session import Session


class HeadlessHost(Host):
    """Runs frames on a fixed clock; what would be drawn is thrown away."""

    def __init__(
        self, session: Session, *, size: tuple[int, int] = (1280, 800), scale: float = 1.0
    ) -> None:
        super().__init__(session, size=size, scale=scale)

    def _make_renderer(self) -> NullRenderer:
        return NullRenderer()

    def resize(self, size: tuple[int, int]) -> bool:
        """Change the size of the window, as `Host.resize` does."""
        self.size = size
        return True

    def frames(self, count: int = 1, *batch: events.InputEvent) -> None:
        """Run frames; the events arrive in the first one."""
        for index in range(count):
            self.step(batch if index == 0 else (), events.FRAME)

    def until(self, done: Callable[[], bool], *, limit: int = 600) -> bool:
        """Run frames until something is so; returns whether it came true within the limit."""
        for _ in range(limit):
            if done():
                return True
            self.frames()
        return done()

    @property
    def cursor(self) -> int:
        """The mouse cursor that the app asks for."""
        return imgui.get_mouse_cursor()
