"""The canvas and the panels around it: where they stand, which are in front, how high they are."""

from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor.actions import view
from editor.toolkit import widgets
from editor.toolkit.appearance import Icons
from editor.toolkit.guarding import guarded
from editor.toolkit.textures import TextureStore
from editor.toolkit.widgets import px
from editor.window import layouts
from editor.window.canvas import Canvas
from editor.window.panels.agents import AgentsPanel
from editor.window.panels.base import Panel
from editor.window.panels.controls import ControlsPanel
from editor.window.panels.curriculum import CurriculumPanel
from editor.window.panels.debug import DebugPanel
from editor.window.panels.evaluate import EvaluatePanel
from editor.window.panels.eye import EyePanel
from editor.window.panels.history import HistoryPanel
from editor.window.panels.inspector import Inspector
from editor.window.panels.level import LevelPanel
from editor.window.panels.log import LogPanel
from editor.window.panels.outliner import Outliner
from editor.window.panels.plots import PlotsPanel
from editor.window.panels.problems import ProblemsPanel
from editor.window.panels.tabs import DocumentTabs
from editor.window.panels.timeline import Timeline
from editor.window.panels.training import TrainingPanel
from editor.window.tab_words import TabWords

if TYPE_CHECKING:
    from editor.session import Session

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
_SETTLED_FRAMES: Final = 30
"""While the layout settles every panel is in front once."""


class Workplace:
    """Everything between the bars while the gallery is closed."""

    def __init__(self, session: "Session", textures: TextureStore) -> None:
        self.session = session
        self.canvas = Canvas(textures)
        self._tabs = DocumentTabs()
        self._tab_words = TabWords()
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
        self._room: layouts.Room | None = None
        """The room that the layout is for; None: not known yet."""
        self._other_rooms: dict[layouts.Room, str] = {}
        """Layouts of this run for windows with other room."""
        self._rescaled = ""
        """The layout for another scale, to be taken before the next frame."""
        self._in_front: list[str] = []
        """Ids of panels to bring to the front, one a frame."""
        self._row = layouts.LowerRow()
        self._seen: set[str] = set()
        """Ids of the panels that were on the screen in the last frame."""
        self._drawn: list[Panel] = []
        """Panels of this frame whose content is on the screen."""
        self._front_before: frozenset[str] = frozenset()
        self._pressed_tab = ""
        """Id of the panel in front whose tab is being clicked."""
        self._asked = ""
        """Id of a panel that was brought to the front on demand."""
        self._brought = 0
        """The frame in which a panel was brought to the front last."""
        self._put_up = 0
        """The frame in which the panels were last put up: at first, rebuilt, or shown again."""
        self._had_bars = False
        self._panel_focused = False
        self._to_canvas = True
        self._debugged = False

    @property
    def panel_focused(self) -> bool:
        """True if the keyboard is in a panel."""
        return self._panel_focused

    def take_layout(self) -> None:
        """Take a stored layout that is asked for; Dear ImGui does so only between frames."""
        asked, settings = self.session.view, self.session.settings
        if self._rescaled:
            self._restore(self._rescaled)
            self._rescaled = ""
        elif not self._laid_out and not asked.layout:
            # What version 0.1.0 left had little room for the canvas: the new arrangement is better.
            known = layouts.is_current(settings.layout)
            self._laid_out = known and self._restore(settings.layout)
            if self._laid_out:
                self._room = layouts.room_of(settings.layout)
        elif asked.layout in settings.layouts and not self.session.gallery.open:
            if self._restore(settings.layouts[asked.layout]):
                self._laid_out = True
            else:
                self.session.complain(f"{asked.layout} is from an older version: save it again.")
            asked.layout = ""

    def rescale(self, ratio: float) -> None:
        """Keep the panels where they are, in pixels of another scale, where there is room still.

        Args:
            ratio: New scale over old; 1 where only the text's size changed.
        """
        if not self._laid_out or ratio == 1.0:
            return
        kept = layouts.snapshot(self._seen, px(1) / ratio)
        if self._room in (None, layouts.room_now()):
            self._rescaled = kept
        else:
            # At the new scale the window has room for other columns.
            self._other_rooms[self._room] = kept

    def hidden(self) -> None:
        """Note that the gallery stands in front of the panels."""
        self._had_bars = False

    def follow_switches(self) -> None:
        """Bring the debug panel in front when its key turns it on; what is asked for is shown."""
        asked = self.session.view
        # The drawing alone needs no panel.
        spare = layouts.room_now() is not layouts.Room.LOW and view.shows_panels(self.session)
        if asked.debug_draw and spare and not self._debugged:
            asked.front = "debug"
        self._debugged = asked.debug_draw
        if asked.front:
            self._in_front.append(asked.front)
            self._asked = asked.front
            asked.front = ""
            asked.panels_in_play = asked.panels_in_play or not self.session.editing

    def draw(self, space: int, bars: bool) -> None:
        """Draw the canvas and, if wanted, the panels around it."""
        if not self._laid_out or self.session.view.layout:
            self._lay_out(space)
        elif self._room is None:
            self._room = layouts.room_now()
        elif layouts.room_now() is not self._room:
            self._change_room(space, self._room)
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
                self.canvas.framing.measuring = any(panel.measures for panel in self._drawn)

    def _restore(self, stored: str) -> bool:
        taken = layouts.restore(stored, self.panels)
        if taken:
            self.canvas.framing.refit()
            self._put_up = imgui.get_frame_count()
            front = layouts.front_of(stored)
            self._in_front = [panel.id for panel in self.panels if panel.id in front]
        return taken

    def _lay_out(self, space: int) -> None:
        """Put the panels where an arrangement that comes with the app has them."""
        self._laid_out, view = True, self.session.view
        self.canvas.framing.refit()
        self._put_up = imgui.get_frame_count()
        plan = layouts.ARRANGEMENTS.get(view.layout, layouts.ARRANGEMENTS["edit"])
        view.layout = ""
        layouts.arrange(space, self.panels, plan)
        self._in_front = list(plan.front)

    def _change_room(self, space: int, before: layouts.Room) -> None:
        """Take the layout for the room that the window has now: the one from then, or the first."""
        self._room = layouts.room_now()
        self._other_rooms.setdefault(before, layouts.snapshot(self._seen))
        kept = self._other_rooms.pop(self._room, None)
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
            with guarded(self.session):
                if bars:
                    self._tabs.draw(self.session)
                self.canvas.interact(self.session)
        imgui.end()
        imgui.pop_style_var(3)

    def paint(self) -> None:
        """Draw the level last, so that what this frame's input did is seen in this frame."""
        if imgui.begin(_CANVAS, None, _CANVAS_FLAGS)[0]:
            with guarded(self.session):
                self.canvas.paint(self.session)
        imgui.end()

    def _panel(self, panel: Panel) -> bool:
        """Draw a panel's window; returns whether the keyboard is there."""
        imgui.set_next_window_size((px(320), px(400)), imgui.Cond_.first_use_ever.value)
        first = self._in_front[0] if self._in_front else ""
        # Of two in one frame Dear ImGui would bring only the last to the front.
        ready = imgui.get_frame_count() > max(self._put_up + 1, self._brought)
        # Under a question it brings none there.
        ready = ready and imgui.internal.get_top_most_popup_modal() is None
        if panel.id == first and ready:
            self._brought = imgui.get_frame_count()
            # Of panels that share a place, the one docked last is in front unless told otherwise.
            imgui.set_next_window_focus()
            self._in_front.pop(0)
            # The keyboard goes back to the canvas, unless a field was asked for.
            self._to_canvas = not self.session.view.field
        opened = imgui.begin(self._tab_words.name(panel))[0]
        if not self._tab_words.has_words(panel) and not self.session.view.covered:
            widgets.tooltip(panel.title)
        lower = self._row.holds_current()
        self._tab_words.note(panel, folds=lower)
        if lower and imgui.is_item_clicked(0) and panel.id not in self._seen:
            # The last item is the tab. A click is meant, also while the layout settles.
            self._asked = panel.id
        self._give_height(panel, opened)
        if lower and opened:
            self._fold(panel)
        if opened and not (lower and self._row.folded()):
            self._drawn.append(panel)
            with guarded(self.session):
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
                self._toggle_row()
        node = imgui.internal.get_window_dock_node()
        folded = self._row.folded()
        if node is None or not imgui.internal.dock_node_begin_amend_tab_bar(node):
            return
        icon = Icons.better if folded else Icons.worse
        trailing = imgui.TabItemFlags_.trailing.value | imgui.TabItemFlags_.no_tooltip.value
        pressed = imgui.tab_item_button(f"{icon}###fold", trailing)
        widgets.probe(self.session, "lower.fold")
        if not (self.session.view.covered or self.session.view.palette or self.session.prompts):
            words = "A click on the tab in front does it too."
            widgets.tooltip("Open" if folded else "Fold", words)
        imgui.internal.dock_node_end_amend_tab_bar()
        if pressed:
            self._toggle_row()

    def _toggle_row(self) -> None:
        """Fold or open the row; an arena that was shown whole is so in the room that is left."""
        self._row.toggle()
        self.canvas.framing.refit()

    def _give_height(self, panel: Panel, opened: bool) -> None:
        """Make a panel that has just come to the front as high as it must be, its tab in sight."""
        fresh = opened and panel.id not in self._seen
        self._front_before = frozenset(self._seen)
        # Panels that come back are all open for a frame before they are docked.
        docked = imgui.get_frame_count() > self._put_up + 1
        asked = opened and docked and panel.id == self._asked
        if fresh:
            layouts.show_tab()
        fits = asked or (fresh and self.session.view.settled and not self._row.folded())
        if fits and self._row.fit(panel.height):
            self.canvas.framing.refit()
        if opened:
            self._seen.add(panel.id)
            self._asked = "" if asked else self._asked
        else:
            self._seen.discard(panel.id)

    def save_layout(self) -> None:
        """Remember where the panels are, in the settings."""
        if self._laid_out and not self._in_front:
            self.session.settings.layout = layouts.snapshot(self._seen)

    def _keep_layout(self) -> None:
        """Remember where the panels are under the name that was asked for."""
        asked = self.session.view
        if asked.layout_name:
            self.session.settings.layouts[asked.layout_name] = layouts.snapshot(self._seen)
            self.session.toast(f"Kept this layout as {asked.layout_name}", "success")
            asked.layout_name = ""
