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
from editor.toolkit import keys, theme, widgets
from editor.toolkit.appearance import COLOURS, FONTS, Icons
from editor.toolkit.fonts import Fallbacks
from editor.toolkit.textures import TextureStore
from editor.toolkit.widgets import px
from editor.window import layouts
from editor.window.canvas import Canvas
from editor.window.dialogs import Dialogs
from editor.window.panels.agents import AgentsPanel
from editor.window.panels.base import Panel
from editor.window.panels.controls import ControlsPanel
from editor.window.panels.curriculum import CurriculumPanel
from editor.window.panels.debug import DebugPanel
from editor.window.panels.evaluate import EvaluatePanel
from editor.window.panels.eye import EyePanel
from editor.window.panels.gallery.page import GalleryPage
from editor.window.panels.guide import GuideCard
from editor.window.panels.help import HelpOverlay
from editor.window.panels.history import HistoryPanel
from editor.window.panels.inspector import Inspector
from editor.window.panels.keys import KeysWindow
from editor.window.panels.level import LevelPanel
from editor.window.panels.log import LogPanel
from editor.window.panels.menu import MenuBar
from editor.window.panels.outliner import Outliner
from editor.window.panels.palette import CommandPalette
from editor.window.panels.plots import PlotsPanel
from editor.window.panels.preferences import PreferencesWindow
from editor.window.panels.problems import ProblemsPanel
from editor.window.panels.status import StatusBar
from editor.window.panels.tabs import DocumentTabs
from editor.window.panels.timeline import Timeline
from editor.window.panels.toasts import Toasts
from editor.window.panels.toolbar import Toolbar
from editor.window.panels.training import TrainingPanel
from editor.window.preparing import Preparation
from editor.window.tab_words import TabWords
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
_CANVAS_FLAGS: Final = (
    imgui.WindowFlags_.no_decoration.value
    | imgui.WindowFlags_.no_move.value
    | imgui.WindowFlags_.no_docking.value
    | imgui.WindowFlags_.no_saved_settings.value
    | imgui.WindowFlags_.no_bring_to_front_on_focus.value
    | imgui.WindowFlags_.no_background.value
    | imgui.WindowFlags_.no_scroll_with_mouse.value
    | imgui.WindowFlags_.no_nav_inputs.value
)
_CANVAS: Final = "Canvas"
_FALLBACK_FRAME: Final = 20
"""The system's fonts are looked for after the window can be used."""
_WARM_UP_FRAME: Final = 3
"""JAX is imported only after the window can be used."""
_LAYOUT_FRAMES: Final = 30
"""So often the settings learn where the panels are."""
_SETTLED_FRAMES: Final = 30
"""While the layout settles every panel is in front once."""


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
        self.canvas = Canvas(textures)
        self._menu = MenuBar()
        self._toolbar = Toolbar()
        self._status = StatusBar()
        self._tabs = DocumentTabs()
        self._tab_words = TabWords()
        self._toasts = Toasts()
        self._dialogs = Dialogs()
        self._palette = CommandPalette()
        self._help = HelpOverlay()
        self._guide = GuideCard()
        self._keys_window = KeysWindow()
        self._preferences = PreferencesWindow()
        self._gallery = GalleryPage(textures)
        self.panels: tuple[Panel, ...] = (
            Outliner(),
            LevelPanel(),
            Inspector(),
            ProblemsPanel(),
            HistoryPanel(),
            ControlsPanel(),
            Timeline(),
            PlotsPanel(),
            AgentsPanel(),
            EyePanel(textures),
            EvaluatePanel(),
            TrainingPanel(),
            CurriculumPanel(textures),
            DebugPanel(),
            LogPanel(),
        )
        self._laid_out = False
        self._narrow: bool | None = None
        """True if the layout is that of a narrow window; None: a stored one has been taken."""
        self._other_widths: dict[bool, str] = {}
        """Layouts of this run for wide (False) and narrow (True) windows."""
        self._rescaled = ""
        """The layout for another scale, to be taken before the next frame."""
        self._in_front: list[str] = []
        """Ids of panels to bring to the front, one a frame."""
        self.preparation = Preparation(session, self._compiled)
        self._row = layouts.LowerRow()
        self._fallbacks = Fallbacks([each for each in (FONTS.regular, FONTS.bold) if each])
        self._seen: set[str] = set()
        self._drawn: list[Panel] = []
        """Panels of this frame whose content is on the screen."""
        """Ids of the panels that were on the screen in the last frame."""
        self._front_before: frozenset[str] = frozenset()
        self._pressed_tab = ""
        """Id of the panel in front whose tab is being clicked."""
        self._asked = ""
        """Id of a panel that was brought to the front on demand."""
        self._brought = 0
        """The frame in which a panel was brought to the front last."""
        self._put_up = 0
        """The frame in which the panels were put up last: at first, anew, or after being hidden."""
        self._had_bars = False
        self._panel_focused = False
        self._popup = False
        """True if a pop-up was open in the last frame."""
        self._to_canvas = True
        self._switches: dict[str, bool] = {}
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
            or (session.gallery.open and self._gallery.animating(session))
            or not session.worker.idle
            or not session.evaluator.idle
            or (session.viewer.curriculum.open and session.viewer.curriculum.drawing)
            or imgui.get_io().want_text_input
        )

    def notice(self, event: events.InputEvent) -> None:
        """Take an event that is not Dear ImGui's: focus, dropped files, the close button."""
        actions.handle(self.session, event)

    def before_frame(self) -> None:
        """Do what Dear ImGui takes only between frames: stored layouts, further fonts."""
        asked, settings = self.session.view, self.session.settings
        if imgui.get_frame_count() > _FALLBACK_FRAME:
            self._fallbacks.step()
        if self._rescaled:
            self._restore(self._rescaled)
            self._rescaled = ""
        elif not self._laid_out and not asked.layout:
            # What version 0.1.0 left had little room for the canvas: the new arrangement is better.
            known = layouts.is_current(settings.layout)
            self._laid_out = known and self._restore(settings.layout)
            if self._laid_out:
                self._narrow = layouts.of_narrow(settings.layout)
        elif asked.layout in settings.layouts and not self.session.gallery.open:
            if self._restore(settings.layouts[asked.layout]):
                self._laid_out = True
            else:
                self.session.complain(f"{asked.layout} is from an older version: keep it anew.")
            asked.layout = ""

    def _restore(self, stored: str) -> bool:
        taken = layouts.restore(stored, self.panels)
        if taken:
            self.canvas.refit()
            self._put_up = imgui.get_frame_count()
            front = layouts.front_of(stored)
            self._in_front = [panel.id for panel in self.panels if panel.id in front]
        return taken

    def frame(self, dt: float) -> None:
        """Draw one frame and do what it asked for.

        Args:
            dt: Time since the last frame [s].
        """
        session = self.session
        language.use(session.settings.language)
        self._rescale()
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
            self._keys()
        bars = session.view.interface
        if bars:
            self._bars()
        gallery = session.gallery.open
        flags = imgui.DockNodeFlags_.passthru_central_node.value
        if gallery:
            # The panels keep their places while the gallery is in front of them.
            flags |= imgui.DockNodeFlags_.keep_alive_only.value
        self._follow_switches()
        panels = view.shows_panels(session)
        space = imgui.dock_space_over_viewport(0, None, flags)
        if gallery:
            self._had_bars = False
            self._gallery.draw(session)
        else:
            self._workplace(space, panels)
        with session.guard():
            self._guide.draw(session)
            self._dialogs.draw(session)
            self._palette.draw(session)
            self._help.draw(session)
            self._keys_window.draw(session)
            self._preferences.draw(session)
        with session.guard():
            actions.work(session)
        if not gallery:
            self._paint_canvas()
        arena = 0.0 if gallery else session.camera.to_screen(ARENA[1])[0]
        self._toasts.draw(session, _middle(), beside=arena)
        due = dt >= IDLE or imgui.get_frame_count() % _LAYOUT_FRAMES == 0
        if due and session.view.settled:
            self.save_layout()
        if self.warm_up and imgui.get_frame_count() > _WARM_UP_FRAME:
            self.warm_up = False
            self.preparation.begin()
        self.preparation.tick()

    def _workplace(self, space: int, bars: bool) -> None:
        """The canvas and, if wanted, the panels around it."""
        self._gallery.closed()
        if not self._laid_out or self.session.view.layout:
            self._lay_out(space)
        elif self._narrow is None:
            self._narrow = layouts.is_narrow()
        elif layouts.is_narrow() is not self._narrow:
            self._change_width(space, self._narrow)
        self._canvas(space, bars)
        self._keep_layout()
        if bars != self._had_bars:
            self._had_bars, self._put_up = bars, imgui.get_frame_count()
            # Panels that come back are in front in the order of drawing: bring back who was.
            waiting = self._in_front
            seen = [panel.id for panel in self.panels if panel.id in self._seen]
            self._in_front = [*(each for each in seen if each not in waiting), *waiting]
        self.session.view.settled = imgui.get_frame_count() > self._put_up + _SETTLED_FRAMES
        if bars:
            self._tab_words.choose(self.panels, self._seen)
            self._drawn.clear()
            focused = [self._panel(panel) for panel in self.panels]
            self._panel_focused = any(focused)
            if self.session.view.settled:
                self.canvas.measuring = any(panel.measures for panel in self._drawn)

    def _compiled(self, job: Job) -> None:
        if job.state is JobState.DONE:
            self._toolbar.physics = job.result
            self.canvas.images.enabled |= isinstance(job.request, WarmUp)
        elif job.state is JobState.FAILED:
            self.session.toast(f"Play could not be prepared: {job.error}", "error")

    def _follow_switches(self) -> None:
        """Bring a panel to the front when its key turns it on; what is asked for is shown."""
        asked = self.session.view
        now = {"debug": asked.debug_draw, "plots": asked.plots}
        for panel, on in now.items():
            # The debug drawing alone needs no panel; plots are nothing without theirs.
            shown = panel == "plots" or view.shows_panels(self.session)
            if on and shown and not self._switches.get(panel, False):
                asked.front = panel
        self._switches = now
        if asked.front:
            self._in_front.append(asked.front)
            self._asked = asked.front
            asked.front = ""
            asked.panels_in_play = asked.panels_in_play or not self.session.editing

    def _rescale(self) -> None:
        settings = self.session.settings
        wanted, text = settings.ui_scale or self.host_scale, settings.text_scale
        look = (wanted, text, settings.theme)
        if look == self._look:
            return
        theme.apply(*look)
        if wanted != self.scale or (self._look and text != self._look[1]):
            self._other_widths.clear()
        if self._laid_out and self._look and wanted != self.scale:
            self._rescaled = layouts.scaled(layouts.snapshot(self._seen), wanted / self.scale)
        self.scale, self._look = wanted, look

    def _keys(self) -> None:
        """Hand keys and text on unless a text field or a pop-up owns them."""
        session, io = self.session, imgui.get_io()
        modifiers = events.Modifiers(ctrl=io.key_ctrl, shift=io.key_shift, alt=io.key_alt)
        popup = bool(session.prompts) or imgui.is_popup_open("", imgui.PopupFlags_.any_popup.value)
        # By now Esc has closed the pop-up that was open; the key was that pop-up's all the same.
        closed, self._popup = self._popup and not popup, popup
        taken = (io.want_text_input or popup) and session.hands.capture is None
        navigating = self._navigation(popup)
        there = imgui.is_popup_open("", imgui.PopupFlags_.any_popup.value)
        if self._menu.opened and there and imgui.is_key_pressed(imgui.Key.escape, False):
            # Dear ImGui closes the submenu alone, and the pointer that rests there opens it again.
            imgui.internal.close_popup_to_level(0, True)
        for name, key in keys.IMGUI.items():
            if imgui.is_key_released(key):
                actions.handle(
                    session, events.KeyEvent(key=name, pressed=False, modifiers=modifiers)
                )
            elif imgui.is_key_pressed(key, True):
                repeat = not imgui.is_key_pressed(key, False)
                event = events.KeyEvent(key=name, pressed=True, modifiers=modifiers, repeat=repeat)
                if name == "escape" and (closed or self._closes_overlay()):
                    continue
                moves = name in navigating and not modifiers.ctrl and session.hands.capture is None
                if not taken and not moves:
                    actions.handle(session, event)
        if not taken and session.driver.active:
            typed = "".join(chr(code) for code in io.input_queue_characters)
            if typed:
                actions.handle(session, events.TextEvent(text=typed))

    def _closes_overlay(self) -> bool:
        """Let Esc close the help, the keys' window or the preferences; whether one was open."""
        shown = self.session.view
        if self.session.hands.capture is not None:
            return False
        if not (shown.help or shown.keys or shown.preferences):
            return False
        shown.help = shown.keys = shown.preferences = False
        return True

    def _navigation(self, popup: bool) -> frozenset[str]:
        """Keys that move between the fields of a panel now, so that they are not the app's.

        The arrows nudge and drive, so they must not start Dear ImGui's navigation: it is only on
        while a pop-up is open or the keyboard is in a panel already (Tab there, Esc back).
        """
        io = imgui.get_io()
        flag = imgui.ConfigFlags_.nav_enable_keyboard.value
        inside = io.nav_visible and self.session.editing and self._panel_focused
        if popup or inside or io.want_text_input:
            io.config_flags |= flag
        else:
            io.config_flags &= ~flag
        keys_taken = _NAVIGATION if inside else frozenset()
        return keys_taken | {"tab"} if self._panel_focused and self.session.editing else keys_taken

    def _bars(self) -> None:
        session = self.session
        with session.guard():
            self._menu.draw(session)
        viewport = imgui.get_main_viewport()
        height = imgui.get_frame_height() + 2 * px(6)
        if not session.gallery.open:
            with self._bar("##toolbar", viewport, imgui.Dir.up, height, px(6)) as opened:
                if opened:
                    with session.guard():
                        self._toolbar.draw(session)
        height = imgui.get_text_line_height() + 2 * px(6)
        with self._bar("##status", viewport, imgui.Dir.down, height, px(6)) as opened:
            if opened:
                with session.guard():
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

    def _lay_out(self, space: int) -> None:
        """Put the panels where an arrangement that comes with the app has them."""
        self._laid_out, view = True, self.session.view
        self.canvas.refit()
        self._put_up = imgui.get_frame_count()
        plan = layouts.ARRANGEMENTS.get(view.layout, layouts.ARRANGEMENTS["edit"])
        view.layout = ""
        layouts.arrange(space, self.panels, plan)
        self._in_front = list(plan.front)

    def _change_width(self, space: int, before: bool) -> None:
        """Take the layout for a narrow or a wide window: the one that it had then, or the first."""
        self._narrow = layouts.is_narrow()
        self._other_widths[before] = layouts.snapshot(self._seen)
        kept = self._other_widths.get(self._narrow)
        if kept is not None:
            self._rescaled = kept
        else:
            self._lay_out(space)

    def _canvas(self, space: int, bars: bool) -> None:
        node = imgui.internal.dock_builder_get_central_node(space)
        if bars and node is not None:
            position, size = node.pos, node.size
        else:
            viewport = imgui.get_main_viewport()
            position, size = viewport.work_pos, viewport.work_size
        imgui.set_next_window_pos(position)
        imgui.set_next_window_size(size)
        imgui.push_style_var(imgui.StyleVar_.window_padding, imgui.ImVec2(0, 0))
        imgui.push_style_var(imgui.StyleVar_.window_rounding, 0.0)
        imgui.push_style_var(imgui.StyleVar_.item_spacing, imgui.ImVec2(0, 0))
        if self._to_canvas and not self._in_front:
            imgui.set_next_window_focus()
            self._to_canvas = False
        if imgui.begin(_CANVAS, None, _CANVAS_FLAGS)[0]:
            with self.session.guard():
                if bars:
                    self._tabs.draw(self.session)
                self.canvas.interact(self.session)
        imgui.end()
        imgui.pop_style_var(3)

    def _paint_canvas(self) -> None:
        """Draw the level last, so that what this frame's input did is seen in this frame."""
        if imgui.begin(_CANVAS, None, _CANVAS_FLAGS)[0]:
            with self.session.guard():
                self.canvas.paint(self.session)
        imgui.end()

    def _panel(self, panel: Panel) -> bool:
        """Draw a panel's window; returns whether the keyboard is there."""
        imgui.set_next_window_size((px(320), px(400)), imgui.Cond_.first_use_ever.value)
        first = self._in_front[0] if self._in_front else ""
        # Of two in one frame Dear ImGui would bring only the last to the front.
        ready = imgui.get_frame_count() > max(self._put_up + 1, self._brought)
        if panel.id == first and ready:
            self._brought = imgui.get_frame_count()
            # Of panels that share a place, the one docked last is in front unless told otherwise.
            imgui.set_next_window_focus()
            self._in_front.pop(0)
            # The keyboard goes back to the canvas, unless a field was asked for.
            self._to_canvas = not self.session.view.field
        opened = imgui.begin(self._tab_words.name(panel))[0]
        if not self._tab_words.has_words(panel):
            widgets.tooltip(panel.title)
        lower = self._row.holds_current()
        self._tab_words.note(panel, folds=lower)
        self._give_height(panel, opened)
        if lower and opened:
            self._fold(panel)
        if opened and not (lower and self._row.folded()):
            self._drawn.append(panel)
            with self.session.guard():
                panel.draw(self.session)
        focused = imgui.is_window_focused(imgui.FocusedFlags_.root_and_child_windows.value)
        imgui.end()
        return focused

    def _fold(self, panel: Panel) -> None:
        """Fold the lower row, or open it, by a click on the tab in front or the arrow beside."""
        if imgui.is_item_clicked(0):
            self._pressed_tab = panel.id if panel.id in self._front_before else ""
        still = not imgui.internal.is_mouse_drag_past_threshold(0)
        if self._pressed_tab == panel.id and imgui.is_mouse_released(0):
            self._pressed_tab = ""
            if still and imgui.is_item_hovered():
                self._row.toggle()
        node = imgui.internal.get_window_dock_node()
        folded = self._row.folded()
        if node is None or not imgui.internal.dock_node_begin_amend_tab_bar(node):
            return
        icon = Icons.better if folded else Icons.worse
        trailing = imgui.TabItemFlags_.trailing.value | imgui.TabItemFlags_.no_tooltip.value
        pressed = imgui.tab_item_button(f"{icon}###fold", trailing)
        widgets.probe(self.session, "lower.fold")
        widgets.tooltip("Open" if folded else "Fold", "A click on the tab in front does it too.")
        imgui.internal.dock_node_end_amend_tab_bar()
        if pressed:
            self._row.toggle()

    def _give_height(self, panel: Panel, opened: bool) -> None:
        """Make a panel that has just come to the front as high as it has to be."""
        fresh = opened and panel.id not in self._seen
        self._front_before = frozenset(self._seen)
        # Panels that come back are all open for a frame before they are docked.
        docked = imgui.get_frame_count() > self._put_up + 1
        asked = opened and docked and panel.id == self._asked
        if asked or (fresh and self.session.view.settled):
            self._row.fit(panel.height)
        if opened:
            self._seen.add(panel.id)
            self._asked = "" if asked else self._asked
        else:
            self._seen.discard(panel.id)

    def save_layout(self) -> None:
        """Remember where the panels are, in the settings."""
        if self._laid_out:
            self.session.settings.layout = layouts.snapshot(self._seen)

    def _keep_layout(self) -> None:
        """Remember where the panels are under the name that was asked for."""
        asked = self.session.view
        if asked.layout_name:
            self.session.settings.layouts[asked.layout_name] = layouts.snapshot(self._seen)
            self.session.toast(f"Kept this layout as {asked.layout_name}", "success")
            asked.layout_name = ""


def _middle() -> tuple[tuple[float, float], tuple[float, float]]:
    """Corner and size of what lies between the bars [px]."""
    viewport = imgui.get_main_viewport()
    return (viewport.work_pos.x, viewport.work_pos.y), (viewport.work_size.x, viewport.work_size.y)


_NAVIGATION: Final = frozenset({"left", "right", "up", "down", "space", "return", "tab", "escape"})
"""Keys that move between the fields of a panel while the keyboard is there."""
