"""The menu bar, made from the action table; recent files, examples and looks besides."""

from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor import actions, widgets
from editor.actions import file
from editor.keys import label as chord_label
from editor.look import COLOURS, FONTS, Icons
from editor.settings import GRID_STEPS
from editor.widgets import px
from kinetix.render.palette import PALETTES

if TYPE_CHECKING:
    from editor.session import Session

MENUS: Final = ("File", "Edit", "Tools", "Arrange", "View", "Run", "Level", "Help")
_SCALES: Final = (0.0, 0.75, 1.0, 1.25, 1.5, 2.0, 2.5, 3.0)


class MenuBar:
    """One menu a name in `MENUS`; a row of the table that names none stands in none."""

    def draw(self, session: "Session") -> None:
        """Draw the bar at the top of the window."""
        imgui.push_style_var(imgui.StyleVar_.frame_padding, imgui.ImVec2(px(9), px(6)))
        if imgui.begin_main_menu_bar():
            with widgets.font(FONTS.bold, 0.0):
                widgets.text(f"{Icons.level}  Kinetix", COLOURS.accent)
            imgui.same_line(0, px(14))
            for menu in MENUS:
                opened = imgui.begin_menu(menu)
                widgets.probe(session, f"menu.{menu.lower()}")
                if opened:
                    self._menu(session, menu)
                    imgui.end_menu()
            imgui.end_main_menu_bar()
        imgui.pop_style_var()

    def _menu(self, session: "Session", menu: str) -> None:
        for action in actions.ACTIONS:
            if action.menu == menu:
                item(session, action.id)
        if menu == "File":
            imgui.separator()
            self._recents(session)
            self._examples(session)
        elif menu == "View":
            imgui.separator()
            self._looks(session)

    def _recents(self, session: "Session") -> None:
        recents = session.settings.recents
        if imgui.begin_menu("Open recent", bool(recents)):
            for number, path in enumerate(recents):
                if imgui.menu_item_simple(f"{path}###recent-{number}"):
                    session.queue(lambda path=path: file.open_path(session, path))
            imgui.end_menu()

    def _examples(self, session: "Session") -> None:
        if imgui.begin_menu("Examples"):
            for name, label in actions.examples():
                if imgui.menu_item_simple(f"{label}###example-{name}"):
                    session.queue(lambda name=name: actions.open_example(session, name))
            imgui.end_menu()

    def _looks(self, session: "Session") -> None:
        settings = session.settings
        if imgui.begin_menu("Colours of the level"):
            for name, palette in PALETTES.items():
                if imgui.menu_item_simple(palette.label, None, settings.palette == name):
                    settings.palette = name
            imgui.separator()
            if imgui.menu_item_simple("Role marks", None, settings.glyphs):
                settings.glyphs = not settings.glyphs
            if imgui.menu_item_simple("Role patterns", None, settings.patterns):
                settings.patterns = not settings.patterns
            imgui.end_menu()
        if imgui.begin_menu("Size of the interface"):
            for scale in _SCALES:
                words = f"{scale:.0%}" if scale else "As the display says"
                if imgui.menu_item_simple(words, None, settings.ui_scale == scale):
                    settings.ui_scale = scale
            imgui.end_menu()
        if imgui.begin_menu("Grid"):
            for step in GRID_STEPS:
                if imgui.menu_item_simple(f"{step:g} m", None, settings.grid_step == step):
                    settings.grid_step = step
            imgui.end_menu()
        if imgui.menu_item_simple("Reduced motion", None, settings.reduced_motion):
            settings.reduced_motion = not settings.reduced_motion
        if imgui.menu_item_simple("Reset layout"):
            session.view.layout_reset = True


def item(session: "Session", action_id: str) -> None:
    """One row of a menu."""
    action = actions.BY_ID[action_id]
    chosen = actions.chords(session, action)
    enabled = action.enabled(session)
    checked = action.checked(session) if action.checked is not None else False
    shortcut = chord_label(chosen[0]) if chosen else None
    if imgui.menu_item_simple(f"{action.label}###{action_id}", shortcut, checked, enabled):
        session.queue(action_id)
    widgets.probe(session, f"menu.{action_id}", enabled=enabled)
    if action.tooltip:
        widgets.tooltip(action.label, action.tooltip)
