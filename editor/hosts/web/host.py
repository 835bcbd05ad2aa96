"""The host whose window is a page in a browser."""

import queue
import signal
import sys
from collections.abc import Sequence
from typing import Final

import numpy as np
from imgui_bundle import imgui

from editor.base import events
from editor.base.settings import SCALES
from editor.hosts.base import Host
from editor.hosts.offscreen import OffscreenHost
from editor.hosts.renderer import GlRenderer, Window
from editor.hosts.web.messages import Drawn, FullScreen, Message, Page, Pasted
from editor.hosts.web.outlet import Outlet
from editor.hosts.web.server import PageServer
from editor.session import Session

_MOST_PIXELS: Final = 2560 * 1600
"""Software draws no more than this fast enough; larger pages show a stretched picture."""
_LEAST: Final = (320, 240)
_CURSORS: Final = {
    imgui.MouseCursor_.text_input: "text",
    imgui.MouseCursor_.resize_all: "move",
    imgui.MouseCursor_.resize_ns: "ns-resize",
    imgui.MouseCursor_.resize_ew: "ew-resize",
    imgui.MouseCursor_.resize_nesw: "nesw-resize",
    imgui.MouseCursor_.resize_nwse: "nwse-resize",
    imgui.MouseCursor_.hand: "pointer",
    imgui.MouseCursor_.wait: "wait",
    imgui.MouseCursor_.progress: "progress",
    imgui.MouseCursor_.not_allowed: "not-allowed",
}
"""Names of the browser's pointers; any other is an arrow."""


class PageClipboard:
    """The clipboard of the page's machine, as far as the browser shares it."""

    def __init__(self, outlet: Outlet) -> None:
        self._outlet = outlet
        self._text = ""

    def get(self) -> str:
        """Return the last text that was copied here or pasted there."""
        return self._text

    def set(self, text: str) -> None:
        """Put a text on it."""
        self._text = text
        self._outlet.tell("clipboard", text, lasting=False)

    def pasted(self, text: str) -> None:
        """Take the text of the page's machine."""
        self._text = text

    def install(self) -> None:
        """Make Dear ImGui's text fields use it."""
        platform = imgui.get_platform_io()
        platform.platform_get_clipboard_text_fn = lambda context: self.get()
        platform.platform_set_clipboard_text_fn = lambda context, text: self.set(text)


class WebHost(OffscreenHost):
    """Draws into memory, shows it on a page, takes the page's input.

    The app outlives the page: one that is opened later goes on where the last one was closed.
    """

    def __init__(
        self,
        session: Session,
        *,
        size: tuple[int, int] = (1440, 900),
        scale: float | None = None,
        address: str = "127.0.0.1",
        port: int | None = None,
    ) -> None:
        """Bind the port and set the app up.

        Args:
            session: The app.
            size: Size until a page reports its own [px].
            scale: Scale of the interface; None: as dense as the page's screen is.
            address: What to listen on.
            port: The port; None: 8570, or a free one where that is taken.

        Raises:
            KinetixError: The port cannot be had, or nothing can be drawn.
        """
        self._said: queue.SimpleQueue[list[Message]] = queue.SimpleQueue()
        self._outlet = Outlet(lambda: self._said.put([]))
        self._server = PageServer(self._outlet, self._take, address=address, port=port)
        self._unshown = self._told_to_end = False
        self._scale_given = scale is not None
        super().__init__(session, size=size, scale=scale or 1.0)
        self._page_clipboard = PageClipboard(self._outlet)
        self._page_clipboard.install()
        session.clipboard = self._page_clipboard

    def _make_renderer(self) -> GlRenderer:
        self._pictures = GlRenderer(Window.UNSEEN)
        return self._pictures

    def _present(self) -> bool:
        new = Host._present(self)  # without a window there is nothing to flip
        self._unshown |= new
        self._offer()
        return new

    def _offer(self) -> None:
        """Send the last frame if the page has not got it and can take it."""
        if (self._unshown or self._outlet.fresh) and self.frame_count and self._outlet.wanted:
            self._unshown = False
            self._outlet.show(self._pictures.read(*self.size))

    def poll(self, timeout: float = 0.0) -> list[events.InputEvent]:
        """Return the page's events; waits up to `timeout` seconds for them."""
        said: list[Message] = []
        try:
            said += self._said.get(timeout=timeout) if timeout > 0 else self._said.get_nowait()
            while True:
                said += self._said.get_nowait()
        except queue.Empty:
            pass
        self._offer()
        return self._inputs(said)

    def _take(self, messages: list[Message]) -> None:
        """Take the page's messages, in the server's threads."""
        for message in messages:
            if isinstance(message, Drawn):
                self._outlet.drawn(message.number)
        self._said.put([message for message in messages if not isinstance(message, Drawn)])

    def _inputs(self, said: Sequence[Message]) -> list[events.InputEvent]:
        """Do what is the host's business, and return the rest."""
        inputs: list[events.InputEvent] = []
        for message in said:
            match message:
                case Drawn():
                    pass
                case Page():
                    inputs.append(self._resized(message))
                case Pasted(text=text):
                    self._page_clipboard.pasted(text)
                case FullScreen(on=on):
                    self.session.view.fullscreen = self._fullscreen = on
                case _:
                    inputs.append(message)
        return inputs

    def _resized(self, page: Page) -> events.ResizeEvent:
        width, height = max(page.width, 1), max(page.height, 1)
        shrunk = min((_MOST_PIXELS / (width * height)) ** 0.5, 1.0)
        self.size = (
            max(round(width * shrunk), _LEAST[0]),
            max(round(height * shrunk), _LEAST[1]),
        )
        if not self._scale_given:
            low, high = SCALES
            self.ui.host_scale = min(max(page.density * shrunk, low), high)
        return events.ResizeEvent(width=self.size[0], height=self.size[1])

    def run(self) -> None:
        """Serve until the app is closed or Ctrl+C is pressed; pressed twice, it ends at once."""
        # Flags, no exceptions: Python drops one that is raised while it collects garbage, say. And
        # SDL would make a question of SIGTERM that nobody sees.
        signal.signal(signal.SIGINT, self._be_told_to_end)
        signal.signal(signal.SIGTERM, self._be_told_to_end)
        try:
            self._server.start()
            self._announce()
            super().run()
        except KeyboardInterrupt:
            self._told_to_end = True
        finally:
            if self._told_to_end:
                # The ordinary end of a server. Copies of unsaved levels wait for the next start.
                self.session.save_aside()
                self.session.training.stop()
            self._outlet.tell("ended", True)
            self._outlet.finish()

    @property
    def running(self) -> bool:
        """See `Host.running`."""
        return super().running and not self._told_to_end

    def _be_told_to_end(self, *_: object) -> None:
        if self._told_to_end:
            raise KeyboardInterrupt
        self._told_to_end = True
        self._said.put([])  # it may be waiting for the page

    def _announce(self) -> None:
        """Print the address to open."""
        port = self._server.port
        sys.stdout.write(
            f"Kinetix runs at {self._server.url}\n"
            "The address is a key: who has it can use the editor and this machine's files. From "
            f"another machine: ssh -L {port}:127.0.0.1:{port} HOST, then open it there. "
            "Ctrl+C ends it.\n"
        )
        sys.stdout.flush()

    def _follow(self) -> None:
        """Let the page's title, pointer and full screen follow the app."""
        self._outlet.tell("title", self.ui.window_title)
        cursor = imgui.MouseCursor_(imgui.get_mouse_cursor())
        self._outlet.tell("cursor", _CURSORS.get(cursor, "default"))
        if self.ui.fullscreen != self._fullscreen:
            self._fullscreen = self.ui.fullscreen
            self._outlet.tell("full", self._fullscreen, lasting=False)

    def screenshot(self) -> np.ndarray:
        """Return the window's picture, as `PygameHost.screenshot` does."""
        return self._pictures.read(*self.size)

    def close(self) -> None:
        """See `Host.close`; the page learns that the app has ended."""
        self._server.stop()
        super().close()
