"""The window's one frame: keys, menus, bars, canvas, panels, pop-ups, then everything queued."""

import contextlib
from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor import actions
from editor.actions import view
from editor.actions.dispatch import IDLE
from editor.base import events, language
from editor.base.camera import ARENA
from editor.toolkit import theme
from editor.toolkit.appearance import COLOURS, FONTS
from editor.toolkit.fonts import DrawnLetters, Fallbacks
from editor.toolkit.guarding import guarded
from editor.toolkit.textures import TextureStore
from editor.toolkit.widgets import px
from editor.window.dialogs import Dialogs
from editor.window.keyboard import Keyboard
from editor.window.panels.gallery.page import GalleryPage
from editor.window.panels.guide import GuideCard
from editor.window.panels.help import HelpOverlay
from editor.window.panels.keys import KeysWindow
from editor.window.panels.menu import MenuBar
from editor.window.panels.palette import CommandPalette
from editor.window.panels.preferences import PreferencesWindow
from editor.window.panels.status import StatusBar
from editor.window.panels.toasts import Toasts
from editor.window.panels.toolbar import Toolbar
from editor.window.preparing import Preparation
from editor.window.workplace import Workplace
from editor.worker.jobs import Job, JobState
from editor.worker.requests import WarmUp

if TYPE_CHECKING:
    from editor.session import Session

_BAR_FLAGS: Final = (
    imgui.WindowFlags_.no_saved_settings.value
    | imgui.WindowFlags_.no_scrollbar.value
    | imgui.WindowFlags_.no_scroll_with_mouse.value
    | imgui.WindowFlags_.no_docking.value
    | imgui.WindowFlags_.no_nav_focus.value
)
_FALLBACK_FRAME: Final = 20
"""The system's fonts are looked for after the window can be used."""
_WARM_UP_FRAME: Final = 3
"""JAX is imported only after the window can be used."""
_LAYOUT_FRAMES: Final = 30
"""So often the settings learn where the panels are."""


class Ui:
    """Everything on the screen. One instance a Dear ImGui context."""

    def __init__(self, session: "Session", textures: TextureStore, *, scale: float) -> None:
        self.session = session
        self.textures = textures
        self.scale = 0.0
        self._look: tuple[float, float, str] | None = None
        """Scale, size of the text and theme of the last frame."""
        self.host_scale = scale
        """Scale of the interface where the settings name none."""
        self.asked_scale: float | None = None
        """Scale that the command line names: it holds until the settings' is changed."""
        self._stored_scale = session.settings.ui_scale
        self.workplace = Workplace(session, textures)
        self._keyboard = Keyboard()
        self._menu = MenuBar()
        self._toolbar = Toolbar()
        self._status = StatusBar()
        self._toasts = Toasts()
        self._dialogs = Dialogs()
        self._palette = CommandPalette()
        self._help = HelpOverlay()
        self._guide = GuideCard()
        self._keys_window = KeysWindow()
        self._preferences = PreferencesWindow()
        self._gallery = GalleryPage(textures)
        self.preparation = Preparation(session, self._compiled)
        self._fallbacks = Fallbacks([each for each in (FONTS.regular, FONTS.bold) if each])
        self._letters = DrawnLetters()
        self._fps = 60.0
        self.warm_up = False
        """True if to import JAX and compile in the background once the window stands."""

    @property
    def window_title(self) -> str:
        """Title of the window."""
        document = self.session.document
        mark = "● " if document.dirty else ""
        return f"{mark}{document.title} - Kinetix"

    @property
    def fullscreen(self) -> bool:
        """True if the window is to fill the screen."""
        return self.session.view.fullscreen

    @property
    def animating(self) -> bool:
        """True if the next frame differs without any input."""
        session = self.session
        return (
            session.playback.active
            or bool(session.toasts)
            or session.gallery.work is not None
            or (session.gallery.open and self._gallery.animating(session))
            or not session.worker.idle
            or not session.evaluator.idle
            or (session.viewer.curriculum.open and session.viewer.curriculum.drawing)
            or imgui.get_io().want_text_input
        )

    def save_layout(self) -> None:
        """Remember where the panels are, in the settings."""
        self.workplace.save_layout()

    def notice(self, event: events.InputEvent) -> None:
        """Take an event that is not Dear ImGui's: focus, dropped files, the close button."""
        if isinstance(event, events.QuitEvent) and imgui.get_io().want_text_input:
            self._keyboard.leave_text(event)
        else:
            actions.handle(self.session, event)

    def before_frame(self) -> None:
        """Do what Dear ImGui takes only between frames: stored layouts, further fonts."""
        if imgui.get_frame_count() > _FALLBACK_FRAME:
            self._fallbacks.step()
        self._letters.step()
        self._rescale()
        self.workplace.take_layout()

    def frame(self, dt: float) -> None:
        """Draw one frame and do what it asked for.

        Args:
            dt: Time since the last frame [s].
        """
        session = self.session
        language.use(session.settings.language)
        self._fps += (1.0 / max(dt, 1e-4) - self._fps) * min(1.0, 4.0 * dt)
        session.fps = self._fps
        session.probe.clear()
        with session.guard():
            # Before the panels are drawn: they and the canvas show the same moment.
            actions.advance(session, dt)
        session.viewer.eye_open = session.viewer.timeline_open = False
        session.viewer.curriculum.open = False
        session.highlighted = ()
        with session.guard():
            self._keyboard.take(
                session, submenu=self._menu.opened, in_panel=self.workplace.panel_focused
            )
        bars = session.view.interface
        if bars:
            self._bars()
        gallery = session.gallery.open
        flags = imgui.DockNodeFlags_.passthru_central_node.value
        if gallery:
            # The panels keep their places while the gallery is in front of them.
            flags |= imgui.DockNodeFlags_.keep_alive_only.value
        self.workplace.follow_switches()
        panels = view.shows_panels(session)
        space = imgui.dock_space_over_viewport(0, None, flags)
        if gallery:
            self.workplace.hidden()
            self._gallery.draw(session)
        else:
            self._gallery.closed()
            self.workplace.draw(space, panels)
        with guarded(session):
            self._guide.draw(session)
            self._dialogs.draw(session)
            self._palette.draw(session)
            self._help.draw(session)
            self._keys_window.draw(session)
            self._preferences.draw(session)
        with session.guard():
            if not session.driver.active and not imgui.is_any_item_active():
                # A field that was dragged may be gone before the drag has ended.
                session.document.discard_preview()
            actions.work(session)
            self._keyboard.hand_on(session)
        if not gallery:
            self.workplace.paint()
        arena = 0.0 if gallery else session.camera.to_screen(ARENA[1])[0]
        area = _middle(self._gallery.side)
        self._toasts.draw(session, area, beside=arena, card=self._guide.place)
        due = dt >= IDLE or imgui.get_frame_count() % _LAYOUT_FRAMES == 0
        if due and session.view.settled:
            self.workplace.save_layout()
        if self.warm_up and imgui.get_frame_count() > _WARM_UP_FRAME:
            self.warm_up = False
            self.preparation.begin()
        self.preparation.tick()

    def _compiled(self, job: Job) -> None:
        if job.state is JobState.DONE:
            self._toolbar.physics = job.result
            self.workplace.canvas.images.enabled |= isinstance(job.request, WarmUp)
        elif job.state is JobState.FAILED:
            self.session.toast(f"Play could not be prepared: {job.error}", "error")

    def take_scale(self, scale: float) -> None:
        """Take another scale where the settings name none, as the host or the command line do."""
        self.host_scale = scale
        if self.asked_scale is not None:
            self.asked_scale = scale

    def _rescale(self) -> None:
        settings = self.session.settings
        wanted, text = settings.ui_scale or self.host_scale, settings.text_scale
        if self.asked_scale is not None and settings.ui_scale == self._stored_scale:
            wanted = self.asked_scale
        look = (wanted, text, settings.theme)
        if look == self._look:
            return
        theme.apply(*look)
        if self._look and (wanted, text) != self._look[:2]:
            self.workplace.rescale(wanted / self.scale)
        self.scale, self._look = wanted, look
        self.session.view.scale = px(1.0)

    def _bars(self) -> None:
        session = self.session
        with guarded(session):
            self._menu.draw(session)
        viewport = imgui.get_main_viewport()
        height = imgui.get_frame_height() + 2 * px(6)
        if not session.gallery.open:
            with self._bar("##toolbar", viewport, imgui.Dir.up, height, px(6)) as opened:
                if opened:
                    with guarded(session):
                        self._toolbar.draw(session)
        height = imgui.get_text_line_height() + 2 * px(6)
        with self._bar("##status", viewport, imgui.Dir.down, height, px(6)) as opened:
            if opened:
                with guarded(session):
                    self._status.draw(session)

    @contextlib.contextmanager
    def _bar(
        self, name: str, viewport: imgui.Viewport, side: imgui.Dir, height: float, pad: float
    ) -> Iterator[bool]:
        imgui.push_style_var(imgui.StyleVar_.window_padding, imgui.ImVec2(px(10), pad))
        imgui.push_style_color(imgui.Col_.window_bg, imgui.ImVec4(*COLOURS.raised))
        imgui.push_style_var(imgui.StyleVar_.window_min_size, imgui.ImVec2(1, 1))
        opened = imgui.internal.begin_viewport_side_bar(name, viewport, side, height, _BAR_FLAGS)
        try:
            yield opened
        finally:
            imgui.end()
            imgui.pop_style_var(2)
            imgui.pop_style_color()


def _middle(side: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """Corner and size of what lies between the bars, and before a column at the right [px]."""
    viewport = imgui.get_main_viewport()
    size = viewport.work_size
    return (viewport.work_pos.x, viewport.work_pos.y), (size.x - side, size.y)
