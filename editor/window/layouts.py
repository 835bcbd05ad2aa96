"""Arrangements of the panels: three that come with the app, and those that users keep."""

import dataclasses
import enum
import re
from collections.abc import Collection, Sequence
from typing import Final

from imgui_bundle import imgui

from editor.toolkit.widgets import px
from editor.window.panels.base import Panel


@dataclasses.dataclass(frozen=True, kw_only=True)
class Arrangement:
    """Division of the window, and the panel in front where several share a place."""

    label: str
    left: float = 250.0
    """Width of the left column [px at 100 %]; 0: what belongs there goes to the lower right."""
    right: float = 310.0
    bottom: float = 190.0
    """Height of the lower row [px at 100 %]."""
    most: float = 0.28
    """Largest share of the window's height for the lower row."""
    folded: bool = False
    """True if the lower row begins as a strip of its tabs."""
    below: frozenset[str] = frozenset({"outliner", "level", "inspector"})
    """Panels that stand below the others at the right where there is no left column."""
    beside: frozenset[str] = frozenset({"agents", "eye", "inspector"})
    """Panels at the right of a low window, in one place; all others go to the lower row."""
    front: tuple[str, ...] = ()

    def fitting(self, room: "Room") -> "Arrangement":
        """Return it for a window: one that is not wide has no left column."""
        if room is Room.WIDE or not self.folded:
            return self
        return dataclasses.replace(self, left=0.0, below=frozenset({"outliner", "level"}))


NARROW: Final = 1180.0
"""In a narrower window two columns would take the canvas's place [px at 100 %]."""
LOW: Final = 440.0
"""In a narrow window below this height two panels above each other show next to nothing."""


class Room(enum.StrEnum):
    """Room of the window for panels; each has layouts of its own."""

    WIDE = enum.auto()
    NARROW = enum.auto()
    LOW = enum.auto()
    """Narrow as well."""


ARRANGEMENTS: Final = {
    "edit": Arrangement(
        label="Edit",
        folded=True,
        beside=frozenset({"outliner", "level", "inspector"}),
        front=("level", "outliner", "problems", "inspector"),
    ),
    "play": Arrangement(
        label="Play", left=0.0, bottom=230.0, front=("inspector", "timeline", "agents")
    ),
    "evaluate": Arrangement(
        label="Evaluate",
        left=0.0,
        bottom=420.0,
        most=0.52,
        front=("inspector", "evaluate", "agents"),
    ),
}
"""Those that come with the app, by id."""

_MOST_GIVEN: Final = 0.46
"""Largest share of the window that a panel is given by itself."""
_COLUMNS: Final = {
    "outliner": "left",
    "level": "lower left",
    "history": "left",
    "controls": "lower left",
    "inspector": "right",
    "agents": "right",
    "eye": "right",
}
"""Places of panels; all others share the lower row."""
_ELSE_BELOW: Final = frozenset({"history", "controls"})
"""Panels that go to the lower row where there is no left column: the right one has enough."""


def arrange(space: int, panels: Sequence[Panel], plan: Arrangement) -> None:
    """Divide the dock space and put every panel into its place.

    Args:
        space: Id of the dock space.
        panels: All panels.
        plan: The arrangement.
    """
    node = imgui.internal
    size = _with_room(imgui.get_main_viewport().work_size)
    room = room_now()
    plan = plan.fitting(room)
    node.dock_builder_remove_node_child_nodes(space)
    node.dock_builder_set_node_size(space, size)
    rest, left_share = space, 0.0
    places: dict[str, int] = {}
    if plan.left:
        left_share = min(px(plan.left) / size.x, 0.24)
        split = node.dock_builder_split_node(space, imgui.Dir.left, left_share)
        left, rest = split.id_at_dir, split.id_at_opposite_dir
        split = node.dock_builder_split_node(left, imgui.Dir.down, 0.5)
        places["lower left"], places["left"] = split.id_at_dir, split.id_at_opposite_dir
    right_share = min(px(plan.right) / (size.x * (1 - left_share)), 0.34)
    split = node.dock_builder_split_node(rest, imgui.Dir.right, right_share)
    places["right"], middle = split.id_at_dir, split.id_at_opposite_dir
    if not plan.left and room is not Room.LOW:
        split = node.dock_builder_split_node(places["right"], imgui.Dir.down, 0.4)
        places["lower right"], places["right"] = split.id_at_dir, split.id_at_opposite_dir
    bottom_share = min(px(plan.bottom), plan.most * size.y) / size.y
    if plan.folded:
        bottom_share = strip() / size.y
    split = node.dock_builder_split_node(middle, imgui.Dir.down, bottom_share)
    bottom = split.id_at_dir
    for panel in panels:
        column = _COLUMNS.get(panel.id)
        if room is Room.LOW:
            column = "right" if panel.id in plan.beside else None
        elif not plan.left and panel.id in plan.below:
            column = "lower right"
        spare = bottom if panel.id in _ELSE_BELOW else places["right"]
        place = bottom if column is None else places.get(column, spare)
        node.dock_builder_dock_window(panel.window_name, place)
    node.dock_builder_finish(space)


def _with_room(size: imgui.ImVec2) -> imgui.ImVec2:
    """Return a size that a place can have: in a tiny window there may be nothing left for it."""
    return imgui.ImVec2(max(size.x, 1.0), max(size.y, 1.0))


def room_now() -> Room:
    """Return the room that the window has for panels."""
    size = imgui.get_main_viewport().size
    if size.x / px(1) >= NARROW:
        return Room.WIDE
    return Room.LOW if size.y / px(1) < LOW else Room.NARROW


def strip() -> float:
    """Return the height of a place that is folded to its tabs [px]."""
    return max(imgui.get_frame_height() + px(1), imgui.get_style().window_min_size.y)


def show_tab() -> None:
    """Scroll the tabs where the current window is docked, so that its own is in sight."""
    node = imgui.internal.get_window_dock_node()
    if node is not None and node.tab_bar is not None:
        node.tab_bar.next_scroll_to_tab_id = imgui.internal.get_current_window().tab_id


class LowerRow:
    """The place under the canvas: folded to its tabs, or as high as the panel in front needs.

    A height that the user has dragged stays.
    """

    def __init__(self) -> None:
        self._before = 0.0
        """Height before a panel was given more [px]; 0: nothing was given."""
        self._given = 0.0
        self._open = 0.0
        """Height before it was folded [px]; 0: it has not been folded yet."""

    def holds_current(self) -> bool:
        """Return whether the current window is docked under the canvas."""
        node = imgui.internal.get_window_dock_node()
        above = _canvas_node(node) if node is not None else None
        return node is not None and above is not None and node.pos.y >= above.pos.y + above.size.y

    def folded(self) -> bool:
        """Return whether the current window's place shows its tabs alone."""
        node = imgui.internal.get_window_dock_node()
        return node is not None and node.size.y <= strip() + px(8)

    def toggle(self) -> None:
        """Fold the current window's place to its tabs, or open it again."""
        node = imgui.internal.get_window_dock_node()
        if node is None:
            return
        if self.folded():
            self._set(node, self._usual())
        else:
            self._open, self._before = node.size.y, 0.0
            self._set(node, strip())

    def fit(self, height: float) -> bool:
        """Fit the height of the current window's place to the panel that came to the front.

        Args:
            height: What the panel needs [px at 100 %].

        Returns:
            Whether it is another one.
        """
        node = imgui.internal.get_window_dock_node()
        if node is None:
            return False
        folded = self.holds_current() and self.folded()
        if folded or (self._before and abs(node.size.y - self._given) > px(2)):
            self._before = 0.0
        now = self._usual() if folded else node.size.y
        wanted = max(min(px(height), self._most()), self._before)
        if wanted <= now and not self._before:
            if folded:
                self._set(node, now)
            return folded
        before = self._before or now
        self._given = wanted
        self._before = before if wanted > before else 0.0
        changed = wanted != node.size.y
        self._set(node, wanted)
        return changed

    def _usual(self) -> float:
        return min(self._open or px(ARRANGEMENTS["edit"].bottom), self._most())

    def _most(self) -> float:
        return imgui.get_main_viewport().work_size.y * _MOST_GIVEN

    def _set(self, node: imgui.internal.DockNode, height: float) -> None:
        size = _with_room(imgui.ImVec2(node.size.x, height))
        imgui.internal.dock_builder_set_node_size(node.id_, size)


def _canvas_node(node: imgui.internal.DockNode) -> imgui.internal.DockNode | None:
    """Return the node that is left free for the canvas, in the dock space of a node."""
    root = imgui.internal.dock_node_get_root_node(node)
    return imgui.internal.dock_builder_get_central_node(root.id_)


_HEADER: Final = "; kinetix-editor layout 2"
"""First line of a stored layout; one without it may have lost its docks."""
_FRONT_MARK: Final = ", in front: "
_SCALE_MARK: Final = re.compile(rf"{_HEADER}, scale (\d+\.\d+)")
_NODE: Final = re.compile(r"^ *Dock(?:Node|Space) +ID=(0x[0-9A-F]+)", re.MULTILINE)
_WINDOW: Final = re.compile(r"^\[Window\]\[(?:.*###)?panel-(\w+)\]\n((?:\w+=.*\n)*)", re.MULTILINE)
_DOCK: Final = re.compile(r"^DockId=(0x[0-9A-F]+)", re.MULTILINE)
_SIZES: Final = re.compile(r"\b(Size|SizeRef)=(\d+),(\d+)")


def snapshot(front: Collection[str], scale: float | None = None) -> str:
    """Return where the panels are now, as text for the settings.

    Args:
        front: Ids of the panels that are on the screen.
        scale: Of the interface that they were laid out for; by default the present one.
    """
    room = room_now()
    mark = "" if room is Room.WIDE else f", {room}"
    first = f"{_HEADER}, scale {scale or px(1):.4f}{mark}{_FRONT_MARK}{' '.join(sorted(front))}"
    return f"{first}\n{imgui.save_ini_settings_to_memory()}"


def front_of(stored: str) -> tuple[str, ...]:
    """Return the ids of the panels that were in front when a layout was stored."""
    header, _, front = stored.partition("\n")[0].partition(_FRONT_MARK)
    return tuple(front.split()) if is_current(header) else ARRANGEMENTS["edit"].front


def room_of(stored: str) -> Room:
    """Return the room of the window that a stored layout is for."""
    header = stored.partition("\n")[0].partition(_FRONT_MARK)[0]
    return next((room for room in Room if header.endswith(f", {room}")), Room.WIDE)


def is_current(stored: str) -> bool:
    """Return whether a stored layout is from a version whose arrangements are those of today."""
    return stored.startswith(_HEADER)


def for_this_scale(stored: str) -> str:
    """Return a stored layout with every size as at the present scale of the interface."""
    mark = _SCALE_MARK.match(stored)
    scale = float(mark[1]) if mark is not None else 0.0
    factor = px(1) / scale if scale > 0 else 1.0

    def grown(found: re.Match[str]) -> str:
        name, width, height = found.groups()
        return f"{name}={round(int(width) * factor)},{round(int(height) * factor)}"

    return stored if abs(factor - 1.0) < 1e-3 else _SIZES.sub(grown, stored)


def usable(stored: str, panels: Sequence[Panel]) -> bool:
    """Return whether a stored layout has a place for every panel.

    One from before a panel existed has none for it. An early version lost docks: what it stored
    is taken only where every panel is docked still.
    """
    docks = dict(_WINDOW.findall(stored))
    if "\0" in stored or any(panel.id not in docks for panel in panels):
        return False
    nodes = set(_NODE.findall(stored))
    for lines in docks.values():
        dock = _DOCK.search(lines)
        if dock is None and not stored.startswith(_HEADER):
            return False
        if dock is not None and dock.group(1) not in nodes:
            return False
    return True


def restore(stored: str, panels: Sequence[Panel]) -> bool:
    """Put the panels where a stored layout has them.

    Dear ImGui docks windows from a text only between two frames: inside of one they come undocked.

    Args:
        stored: As `snapshot` wrote it.
        panels: All panels.

    Returns:
        Whether it was taken.
    """
    if not usable(stored, panels):
        return False
    imgui.load_ini_settings_from_memory(for_this_scale(stored))
    return True
