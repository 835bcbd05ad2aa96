"""The menu bar, made from the action table; recent files, examples and looks besides."""

import itertools
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor import actions
from editor.actions import view
from editor.actions.files import examples, file
from editor.base.language import tr
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, FONTS, Icons
from editor.toolkit.widgets import px
from editor.window.hints import key_of
from kinetix.paths import levels_dir

if TYPE_CHECKING:
    from editor.session import Session

MENUS: Final = (
    "File",
    "Edit",
    "Tools",
    "Arrange",
    "View",
    "Run",
    "Agent",
    "Level",
    "Gallery",
    "Help",
)
_WITHOUT_A_LEVEL: Final = frozenset({"Edit", "Tools", "Arrange", "Run"})
"""Menus that have nothing to do while the gallery is in front."""

_FOLDER_WIDTH: Final = 200.0
"""Width of the folder beside a recent file [px at 100 %]."""
_MORE: Final = f"{Icons.more}###more"


class MenuBar:
    """One menu a name in `MENUS`; what cannot be used for want of a level is not shown."""

    def __init__(self) -> None:
        self.opened = False
        """True if a menu was open in the last frame."""

    def draw(self, session: "Session") -> None:
        """Draw the bar at the top of the window."""
        self.opened = False
        imgui.push_style_var(imgui.StyleVar_.frame_padding, imgui.ImVec2(px(9), px(6)))
        if imgui.begin_main_menu_bar():
            with widgets.font(FONTS.bold, 0.0):
                widgets.text(f"{Icons.level}  Kinetix", COLOURS.accent)
            imgui.same_line(0, px(14))
            room = imgui.get_window_width() - imgui.get_cursor_pos_x()
            shown = _shown(session)
            fitting = _fitting(shown, room)
            if session.view.menu:
                session.view.menu = False
                _open_by_key(tr(shown[0]) if fitting else _MORE)
            self._row(session, shown[:fitting])
            if fitting < len(shown):
                opened = imgui.begin_menu(_MORE)
                widgets.probe(session, "menu.more")
                if opened:
                    self.opened = True
                    self._row(session, shown[fitting:])
                    imgui.end_menu()
            imgui.end_main_menu_bar()
        imgui.pop_style_var()

    def _row(self, session: "Session", menus: Sequence[str]) -> None:
        """Draw menus, in the bar or in the one that holds what the bar has no room for."""
        for menu in menus:
            opened = imgui.begin_menu(tr(menu))
            widgets.probe(session, f"menu.{menu.lower()}")
            if opened:
                self.opened = True
                self._menu(session, menu)
                imgui.end_menu()

    def _menu(self, session: "Session", menu: str) -> None:
        lists = {
            "file.new": self._new_from,
            "file.open": self._recents,
            "file.open_comparison": self._examples,
            "view.keep_layout": self._layouts,
        }
        shown = [
            action
            for action in actions.ACTIONS
            if action.menu == menu and not (action.passing and not action.enabled(session))
        ]
        for before, action in zip([None, *shown], shown, strict=False):
            if before is not None and before.group != action.group:
                imgui.separator()
            item(session, action.id)
            if action.id in lists:
                lists[action.id](session)

    def _recents(self, session: "Session") -> None:
        """The files that were opened or saved last: their names, their folders beside them."""
        recents = session.settings.recents
        opened = imgui.begin_menu(tr("Open Recent"), bool(recents))
        widgets.probe(session, "menu.recent")
        if not opened:
            return
        for number, path in enumerate(recents):
            folder = widgets.fitted_path(Path(path).parent, px(_FOLDER_WIDTH))
            label = widgets.labelled(Path(path).name, f"recent-{number}")
            if imgui.menu_item_simple(label, folder):
                session.queue(lambda path=path: _open(session, path))
            widgets.probe(session, f"menu.recent.{number}")
            widgets.tooltip(path, own=True)
        imgui.end_menu()

    def _new_from(self, session: "Session") -> None:
        """The levels that a new one can begin with."""
        opened = imgui.begin_menu(tr("New From"))
        widgets.probe(session, "menu.new_from")
        if not opened:
            return
        for template, (label, _) in examples.TEMPLATES.items():
            if imgui.menu_item_simple(tr(f"{label}###new-{template}")):
                session.queue(lambda template=template: examples.new_from(session, template))
            widgets.probe(session, f"menu.new.{template}")
        imgui.end_menu()

    def _examples(self, session: "Session") -> None:
        """The levels that came with the app, by size, and the scenes of the accuracy suite."""
        opened = imgui.begin_menu(tr("Examples"))
        widgets.probe(session, "menu.examples")
        if opened:
            for size in ("s", "m", "l"):
                self._levels(session, size)
            item(session, "level.gallery")
            widgets.small("Known answers")
            self._scenes(session)
            imgui.end_menu()

    def _levels(self, session: "Session", size: str) -> None:
        """The levels of one size in a menu of their own."""
        opened = imgui.begin_menu(tr(f"Size {size.upper()}"))
        widgets.probe(session, f"menu.examples.{size}")
        if not opened:
            return
        for path in sorted((levels_dir() / size).glob("*.json")):
            label = path.stem.replace("_", " ").capitalize()
            if imgui.menu_item_simple(f"{label}###example-{size}-{path.stem}"):
                session.queue(lambda path=path: _open(session, path))
            widgets.probe(session, f"menu.example.{path.stem}")
        imgui.end_menu()

    def _scenes(self, session: "Session") -> None:
        """Scenes of the accuracy suite, a menu for each class; imported when first looked at."""
        from kinetix.scenes import SCENE_CLASSES

        for group in SCENE_CLASSES:
            opened = imgui.begin_menu(tr(group.capitalize()))
            widgets.probe(session, f"menu.scenes.{group}")
            if not opened:
                continue
            for scene in examples.scenes(group):
                label = f"{scene.name.capitalize()}###scene-{scene.id}"
                if imgui.menu_item_simple(tr(label), scene.id):
                    session.queue(lambda scene_id=scene.id: examples.open_scene(session, scene_id))
                widgets.probe(session, f"menu.scene.{scene.id}")
                widgets.tooltip(f"{scene.id}  {scene.name.capitalize()}", scene.note)
            imgui.end_menu()

    def _layouts(self, session: "Session") -> None:
        """The layouts that the user has kept."""
        names = sorted(session.settings.layouts)
        if not imgui.begin_menu(tr("Kept layouts"), bool(names)):
            return
        for name in names:
            if imgui.menu_item_simple(widgets.labelled(name, f"layout-{name}")):
                session.view.layout = name
            widgets.probe(session, f"menu.layout.{name}")
        imgui.separator()
        if imgui.begin_menu(tr("Forget")):
            for name in names:
                if imgui.menu_item_simple(widgets.labelled(name, f"forget-{name}")):
                    session.queue(lambda name=name: view.forget_layout(session, name))
            imgui.end_menu()
        imgui.end_menu()


def _shown(session: "Session") -> list[str]:
    """Return the menus that are of use now."""
    passed = _WITHOUT_A_LEVEL if session.gallery.open else {"Gallery"}
    return [menu for menu in MENUS if menu not in passed]


def _fitting(menus: Sequence[str], room: float) -> int:
    """Return how many menus the bar has room for; where not for all, one more holds the rest.

    Args:
        menus: Their names.
        room: Width that is left in the bar [px].
    """
    gap = 2 * imgui.get_style().item_spacing.x
    ends = list(itertools.accumulate(imgui.calc_text_size(tr(menu)).x + gap for menu in menus))
    if not ends or ends[-1] <= room:
        return len(ends)
    room -= imgui.calc_text_size(Icons.more).x + gap
    return sum(end <= room for end in ends)


def _open_by_key(menu: str) -> None:
    """Open a menu of the bar, and leave the keyboard there: the arrows lead to its neighbours."""
    bar = imgui.internal.get_current_window()
    imgui.internal.focus_window(bar)
    layer, scope = imgui.internal.NavLayer.menu, bar.nav_root_focus_scope_id
    imgui.internal.set_nav_id(imgui.get_id(menu), layer, scope, imgui.internal.ImRect())
    imgui.open_popup(menu)


def _open(session: "Session", path: str | Path) -> None:
    file.open_path(session, path)


def item(session: "Session", action_id: str) -> None:
    """One row of a menu."""
    action = actions.BY_ID[action_id]
    enabled = actions.available(session, action)
    checked = action.checked(session) if action.checked is not None else False
    shortcut = key_of(session, action_id) or None
    if imgui.menu_item_simple(f"{tr(action.label)}###{action_id}", shortcut, checked, enabled):
        session.queue(action_id)
    widgets.probe(session, f"menu.{action_id}", enabled=enabled)
    if action.tooltip:
        widgets.tooltip(action.label, action.tooltip)
