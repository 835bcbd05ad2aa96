"""Common parts of the hosts: a Dear ImGui context, the input feeder, one frame after the other."""

import abc
import signal
import time
from collections.abc import Sequence
from typing import Protocol

from imgui_bundle import imgui, implot

from editor.base import events
from editor.hosts.inputs import InputFeeder
from editor.hosts.recorder import Recorder
from editor.session import Session
from editor.toolkit import theme
from editor.toolkit.appearance import COLOURS
from editor.toolkit.textures import TextureStore
from editor.window.ui import Ui
from kinetix.failures import ending_signals, signals_later

LEAST_SIZE = (320, 240)
"""Smallest size for which the panels are laid out [px]."""
_NOT_FOR_WIDGETS = (
    events.DropEvent | events.QuitEvent | events.FocusEvent | events.PadEvent | events.PinchEvent
)
_HOPELESS = 120
"""After so many failing frames in a row the app ends."""


class Renderer(TextureStore, Protocol):
    """Destination of finished frames."""

    def new_frame(self) -> None:
        """Prepare a frame, before `imgui.new_frame`."""
        ...

    def present(self, width: int, height: int, colour: tuple[float, float, float]) -> bool:
        """After `imgui.render`; returns whether the window shows anything new."""
        ...

    def shutdown(self) -> None:
        """Free what the backend holds, before the context goes."""
        ...


class Host(abc.ABC):
    """Runs the app's one frame function; the hosts differ only in window, clock and renderer."""

    def __init__(self, session: Session, *, size: tuple[int, int], scale: float) -> None:
        self.session = session
        self.size = size
        self.frame_count = 0
        self.endures = False
        """True if the window goes on after a frame that fails; scripts and tests end instead."""
        self._failed = 0
        """Frames in a row that have failed."""
        self.recorder: Recorder | None = None
        """Takes down what the person does, where that is wanted."""
        self._feeder = InputFeeder()
        self._context = imgui.create_context()
        # Ctrl+Tab goes to the next level: Dear ImGui would bring other panels to the front.
        self._context.config_nav_windowing_key_next = 0
        self._context.config_nav_windowing_key_prev = 0
        self._plots = implot.create_context()
        io = imgui.get_io()
        io.set_ini_filename("")
        io.set_log_filename("")
        io.display_size = imgui.ImVec2(*size)
        io.config_flags |= imgui.ConfigFlags_.docking_enable.value
        io.config_windows_move_from_title_bar_only = True
        io.config_drag_click_to_input_text = True  # as our own number fields do
        # A failing panel must not end the app: Dear ImGui closes what it left open.
        io.config_error_recovery = True
        io.config_error_recovery_enable_assert = False
        io.config_error_recovery_enable_tooltip = False
        io.config_error_recovery_enable_debug_log = True
        # A message for programmers; the tests count the things under the pointer themselves.
        io.config_debug_highlight_id_conflicts = False
        theme.load_fonts()
        self._renderer = self._make_renderer()
        self.ui = Ui(session, self._renderer, scale=scale)

    def resize(self, size: tuple[int, int]) -> bool:
        """Take another size [px] in a replay; returns whether this host can."""
        del size
        return False

    @abc.abstractmethod
    def _make_renderer(self) -> Renderer:
        """Return the renderer for the current context."""

    def step(self, batch: Sequence[events.InputEvent], dt: float) -> None:
        """Run one frame.

        Args:
            batch: What the person did since the last frame.
            dt: Time since the last frame [s].
        """
        # Half a frame would leave Dear ImGui in a state in which it crashes.
        with signals_later(signal.SIGINT, *ending_signals()):
            self._step(batch, dt)

    def _step(self, batch: Sequence[events.InputEvent], dt: float) -> None:
        io = imgui.get_io()
        # A window can be made as small as a line; what it shows is cut off then.
        io.display_size = imgui.ImVec2(*map(max, self.size, LEAST_SIZE))
        io.delta_time = max(dt, 1e-5)
        if batch:
            self.session.hands.touched = time.monotonic()
        self._feeder.feed(batch)
        with self.session.guard():
            for event in batch:
                if isinstance(event, _NOT_FOR_WIDGETS):
                    self.ui.notice(event)
            self.ui.before_frame()
        if self.recorder is not None:
            self.recorder.take(batch, dt, (self.size, self.ui.scale))
        self._renderer.new_frame()
        imgui.new_frame()
        self._draw(dt)
        # What a failed frame has left open is closed here.
        imgui.render()
        self._present()
        self.frame_count += 1

    def _draw(self, dt: float) -> None:
        """Draw the frame; one that fails is reported, and the window goes on.

        Raises:
            Exception: The frame failed, and going on is not wanted or has not helped.
        """
        try:
            self.ui.frame(dt)
        except Exception as error:
            self._failed += 1
            if not self.endures or self._failed >= _HOPELESS:
                self.session.save_aside()
                raise
            with self.session.guard():
                raise error
        else:
            self._failed = 0

    def _present(self) -> bool:
        """Draw the frame; whether it differs from the last one."""
        return self._renderer.present(*self.size, COLOURS.backdrop[:3])

    @property
    def running(self) -> bool:
        """False once the app may close."""
        return not self.session.quitting

    def close(self) -> None:
        """Let go of everything; the host cannot be used afterwards."""
        self._renderer.shutdown()
        implot.destroy_context(self._plots)
        imgui.destroy_context(self._context)
