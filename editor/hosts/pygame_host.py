"""The production host: a pygame window with an OpenGL 3.3 core context."""

import contextlib
import time
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

import numpy as np
import pygame
from imgui_bundle import imgui
from PIL import Image

from editor.base import events
from editor.base.settings import USUAL_SIZE, Settings
from editor.hosts.base import Host
from editor.hosts.clipboard import Clipboard
from editor.hosts.display import NO_DISPLAY, seen, start_display
from editor.hosts.gamepad import Gamepads
from editor.hosts.pygame_events import translate
from editor.hosts.renderer import GlRenderer
from editor.hosts.speaker import Speaker
from editor.session import Session
from editor.toolkit.appearance import COLOURS
from kinetix.errors import KinetixError
from kinetix.files.atomic import replacing
from kinetix.render.palette import KINETIX

_CURSORS = {
    imgui.MouseCursor_.arrow: pygame.SYSTEM_CURSOR_ARROW,
    imgui.MouseCursor_.text_input: pygame.SYSTEM_CURSOR_IBEAM,
    imgui.MouseCursor_.resize_all: pygame.SYSTEM_CURSOR_SIZEALL,
    imgui.MouseCursor_.resize_ns: pygame.SYSTEM_CURSOR_SIZENS,
    imgui.MouseCursor_.resize_ew: pygame.SYSTEM_CURSOR_SIZEWE,
    imgui.MouseCursor_.resize_nesw: pygame.SYSTEM_CURSOR_SIZENESW,
    imgui.MouseCursor_.resize_nwse: pygame.SYSTEM_CURSOR_SIZENWSE,
    imgui.MouseCursor_.hand: pygame.SYSTEM_CURSOR_HAND,
    imgui.MouseCursor_.wait: pygame.SYSTEM_CURSOR_WAIT,
    imgui.MouseCursor_.progress: pygame.SYSTEM_CURSOR_WAITARROW,
    imgui.MouseCursor_.not_allowed: pygame.SYSTEM_CURSOR_NO,
}

IDLE_WAIT = 0.25
"""Longest sleep while nothing happens [s]."""
_IDLE_FRAME = 2.0
"""Even then a frame is drawn this often [s]: copies are saved, files watched."""
_COPY_FRAME = 0.5
"""The same while a change waits to be copied [s]."""
_AROUND = (16, 80)
"""Width and height that window frame and task bar need on the screen [px]."""
_SETTLE_FRAMES = 4
"""Frames drawn after the last input, so that hover, layout and tooltips come to rest."""


def automatic_scale(desktop_height: int) -> float:
    """Return the UI scale for a screen: pygame tells no pixel density, so the height must do.

    Args:
        desktop_height: Height of the desktop [px].
    """
    for height, scale in ((2800, 2.0), (2000, 1.5), (1500, 1.25)):
        if desktop_height >= height:
            return scale
    return 1.0


def _icon() -> pygame.Surface:
    """Return the window's sign: a green ball about to meet a blue one."""
    side = 64
    icon = pygame.Surface((side, side), pygame.SRCALPHA)
    pygame.draw.rect(icon, (25, 28, 34), icon.get_rect(), border_radius=14)
    pygame.draw.line(icon, (143, 125, 255), (8, 50), (56, 50), 4)
    for centre, radius, role in (((23, 36), 13, 1), ((46, 40), 9, 2)):
        pygame.draw.circle(icon, KINETIX.roles[role], centre, radius)
    return icon


def fitting(size: tuple[int, int], screen: tuple[int, int]) -> tuple[int, int]:
    """Return the size of a window, or less, so that all of it is on the screen.

    Args:
        size: Width and height that it would have [px].
        screen: Those of the screen, bars and frames included [px].
    """
    (width, height), (wide, high) = size, screen
    return max(min(width, wide - _AROUND[0]), 320), max(min(height, high - _AROUND[1]), 240)


def _last_size(settings: Settings) -> tuple[int, int]:
    last = (settings.window_width, settings.window_height)
    return last if all(last) else USUAL_SIZE


class PygameHost(Host):
    """Opens a window, waits for input while idle, draws at the display's rate otherwise."""

    needs_display: ClassVar[bool] = True
    """True if a window that nobody sees is an error."""

    def __init__(
        self,
        session: Session,
        *,
        size: tuple[int, int] | None = None,
        scale: float | None = None,
        vsync: bool = True,
    ) -> None:
        self._open_window(size or _last_size(session.settings), vsync, told=size is not None)
        if scale is None:
            scale = automatic_scale(pygame.display.get_desktop_sizes()[0][1])
        super().__init__(session, size=pygame.display.get_window_size(), scale=scale)
        clipboard = Clipboard()
        clipboard.install()
        session.clipboard = clipboard
        self._pads = Gamepads()
        self._title = ""
        self._cursor: int | None = None
        self._fullscreen = False
        self._awake = _SETTLE_FRAMES
        self._speaker = Speaker()

    def keep_size(self) -> None:
        """Let the next window be as large as this one is, unless it fills the screen."""
        if self.needs_display and not self._fullscreen:
            settings = self.session.settings
            settings.window_width, settings.window_height = self.size

    def _open_window(self, size: tuple[int, int], vsync: bool, *, told: bool) -> None:
        try:
            start_display()
            if self.needs_display and not seen():
                pygame.display.quit()
                raise KinetixError(NO_DISPLAY)
            if not told:
                size = fitting(size, pygame.display.get_desktop_sizes()[0])
            pygame.key.set_repeat(400, 40)
            for attribute, value in (
                (pygame.GL_CONTEXT_MAJOR_VERSION, 3),
                (pygame.GL_CONTEXT_MINOR_VERSION, 3),
                (pygame.GL_CONTEXT_PROFILE_MASK, pygame.GL_CONTEXT_PROFILE_CORE),
            ):
                pygame.display.gl_set_attribute(attribute, value)
            flags = pygame.OPENGL | pygame.DOUBLEBUF | pygame.RESIZABLE
            pygame.display.set_icon(_icon())
            with warnings.catch_warnings():
                # Without a display's rhythm the loop keeps its own.
                warnings.simplefilter("ignore")
                pygame.display.set_mode(size, flags, vsync=int(vsync))
        except pygame.error as error:
            raise KinetixError(
                f"cannot open a window with OpenGL 3.3: {error}; "
                "without a display use --offscreen, and see scripts/system-packages.txt"
            ) from error

    def _make_renderer(self) -> GlRenderer:
        self._pictures = GlRenderer()
        return self._pictures

    def _present(self) -> bool:
        new = super()._present()
        if new:
            pygame.display.flip()
        return new

    def poll(self, timeout: float = 0.0) -> list[events.InputEvent]:
        """Return the events; wait up to `timeout` seconds for one."""
        raw: list[pygame.event.Event] = []
        if timeout > 0:
            first = pygame.event.wait(int(timeout * 1000))
            raw += [first] if first.type != pygame.NOEVENT else []
        raw += pygame.event.get()
        batch = [event for one in raw for event in self._translated(one)]
        if any(isinstance(event, events.ResizeEvent) for event in batch):
            self.size = pygame.display.get_window_size()
        if any(event.type == pygame.WINDOWEXPOSED for event in raw):
            self._awake = _SETTLE_FRAMES
            self._pictures.invalidate()
        return batch

    def _translated(self, raw: pygame.event.Event) -> list[events.InputEvent]:
        """Translate an event of pygame's; an error in it is reported, and the app goes on."""
        with self.session.guard():
            event = translate(raw)
            return [event] if event is not None else self._pads.translate(raw)
        return []

    def run(self) -> None:
        """Draw until the app is closed. Without input and without play it sleeps."""
        last = time.perf_counter()
        self.endures = self.session.attended = True
        while self.running:
            idle = self._awake <= 0 and not self.ui.animating and not self._feeder.pending
            batch = self.poll(IDLE_WAIT if idle else 0.0)
            if batch:
                self._awake = _SETTLE_FRAMES
            elif idle and time.perf_counter() - last < self._idle_frame:
                continue
            now = time.perf_counter()
            self.step(batch, min(now - last, 0.25))
            last = now
            self._awake -= 1
            self._follow()
            spare = events.FRAME - (time.perf_counter() - now)
            if spare > 0.002:
                # Where vsync does not pace the loop, the cores belong to the simulation.
                time.sleep(spare)

    @property
    def _idle_frame(self) -> float:
        """After how long a frame is drawn even though nothing happens [s]."""
        return _COPY_FRAME if self.session.autosaves.pending else _IDLE_FRAME

    def _follow(self) -> None:
        """Let title, cursor and full screen follow the app."""
        title = self.ui.window_title
        if title != self._title:
            pygame.display.set_caption(title)
            self._title = title
        cursor = _CURSORS.get(
            imgui.MouseCursor_(imgui.get_mouse_cursor()), pygame.SYSTEM_CURSOR_ARROW
        )
        if cursor != self._cursor:
            # Drivers without a screen have no system cursors.
            with contextlib.suppress(pygame.error):
                pygame.mouse.set_cursor(cursor)
            self._cursor = cursor
        if self.ui.fullscreen != self._fullscreen:
            pygame.display.toggle_fullscreen()
            self._fullscreen = self.ui.fullscreen
            self.size = pygame.display.get_window_size()

    def screenshot(self) -> np.ndarray:
        """Return the window as drawn last: uint8[height, width, 3], top row first."""
        return self._pictures.pixels(*self.size, COLOURS.backdrop[:3])

    def save_screenshot(self, path: Path) -> None:
        """Write the last frame as a PNG file; its folder is made if need be."""
        path.parent.mkdir(parents=True, exist_ok=True)
        picture = Image.fromarray(self.screenshot())
        with replacing(path) as temporary:
            picture.save(temporary, format="PNG")

    def _wanted_screenshot(self) -> None:
        """Take the picture that the app asked for."""
        path = self.session.screenshot
        if path is None:
            return
        self.session.screenshot = None
        try:
            self.save_screenshot(path)
        except (OSError, KinetixError) as error:
            self.session.toast(str(error), "error")
        else:
            self.session.toast(f"Saved {path}", "success")

    def step(self, batch: Sequence[events.InputEvent], dt: float) -> None:
        """See `Host.step`; afterwards takes the picture that was asked for."""
        super().step(batch, dt)
        self._sound()
        self._wanted_screenshot()

    def _sound(self) -> None:
        """Play what the app wants to be heard."""
        session = self.session
        self._speaker.play(session.sound.take(), session.settings.volume)
        if self._speaker.fault and not session.sound.fault:
            session.sound.fault = self._speaker.fault
            session.log.add(session.sound.fault)

    def close(self) -> None:
        """See `Host.close`; the window goes too."""
        super().close()
        self._speaker.close()
        pygame.display.quit()
