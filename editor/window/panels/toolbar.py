"""The bar at the top: files, undo, tools, play, snapping, physics."""

import dataclasses
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor import actions
from editor.actions.playing import physics
from editor.base.language import tr
from editor.play.mode import Mode
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, Icons, Rgba
from editor.toolkit.widgets import px
from editor.window.hints import key_of
from kinetix.engine.names import PHYSICS

if TYPE_CHECKING:
    from editor.session import Session

TOOL_ICONS: Final = {
    "select": Icons.select,
    "rectangle": Icons.rectangle,
    "circle": Icons.circle,
    "triangle": Icons.triangle,
    "joint": Icons.joint,
    "weld": Icons.weld,
    "thruster": Icons.thruster,
}


def action_button(
    session: "Session",
    action_id: str,
    icon: str,
    *,
    label: str = "",
    on: bool = False,
    tint: Rgba | None = None,
) -> None:
    """A button for a row of the action table, with its tooltip and key."""
    action = actions.BY_ID[action_id]
    enabled = action.enabled(session)
    pressed = widgets.icon_button(
        session,
        action_id,
        icon,
        label=label,
        on=on or (action.checked is not None and action.checked(session)),
        enabled=enabled,
        tint=tint,
        height=imgui.get_frame_height(),
    )
    if pressed:
        session.queue(action_id)
    widgets.tooltip(action.label, action.tooltip, key_of(session, action_id))


@dataclasses.dataclass(frozen=True, kw_only=True)
class Plan:
    """The parts of the bar that are shown at one width of the window."""

    labels: bool = True
    """Words beside the signs of tools and Play."""
    physics: bool = True
    """The name of the physics, besides its sign."""
    snapping: bool = True
    """Snapping and grid: they are in the View menu, and on canvas menus, too."""
    files: bool = True
    """New, open, save: they are in the File menu too."""
    history: bool = True
    """Undo and redo."""
    view: bool = True
    """Snapping, grid and physics, as far as they are shown."""


PLANS: Final = (
    Plan(),
    Plan(labels=False),
    Plan(labels=False, physics=False),
    Plan(labels=False, physics=False, snapping=False),
    Plan(labels=False, physics=False, files=False),
    Plan(labels=False, physics=False, files=False, history=False),
    Plan(labels=False, physics=False, files=False, view=False),
    Plan(labels=False, physics=False, files=False, history=False, view=False),
)
"""The widest first; the first one that fits is taken. What goes is in the menus."""

_FILES: Final = (("file.new", Icons.new), ("file.open", Icons.open), ("file.save", Icons.save))
_HISTORY: Final = (("edit.undo", Icons.undo), ("edit.redo", Icons.redo))
_TRANSPORT: Final = (
    ("run.stop", Icons.stop),
    ("run.pause", Icons.pause),
    ("run.step_back", Icons.step_back),
    ("run.step", Icons.step),
    ("run.change", Icons.rename),
    ("run.reset", Icons.reset),
    ("run.slower", Icons.slower),
    ("run.faster", Icons.faster),
)
_GAP: Final = 2.0
"""Between buttons [px at 100 %]."""
_SEPARATOR: Final = 17.0
"""Width of a line between groups with its room [px at 100 %]."""
_PHYSICS_WIDTH: Final = 150.0


class Toolbar:
    """One line under the menu, not a dockable panel."""

    def __init__(self) -> None:
        self.physics: tuple[str, ...] = PHYSICS
        """Names of the presets and solvers; the engine's own once it is loaded."""

    def draw(self, session: "Session") -> None:
        """Draw the bar into the current window: as much of it as fits."""
        space = imgui.get_window_width()
        room = space - 2 * imgui.get_style().window_padding.x
        plan = next((p for p in PLANS if self._width(session, p) <= room), PLANS[-1])
        if session.editing:
            self._editing(session, plan)
        else:
            self._transport(session)
        if plan.view:
            self._right(session, plan, space)

    def _editing(self, session: "Session", plan: Plan) -> None:
        for buttons, shown in ((_FILES, plan.files), (_HISTORY, plan.history)):
            if shown:
                for action, icon in buttons:
                    action_button(session, action, icon)
                    imgui.same_line(0, px(_GAP))
                widgets.separator_gap()
        self._tools(session, labels=plan.labels)
        widgets.separator_gap()
        label = "Play" if plan.labels else ""
        action_button(session, "run.play_human", Icons.play, label=label, tint=COLOURS.play)

    def _width(self, session: "Session", plan: Plan) -> float:
        """Return the width that a plan needs [px]."""
        plain = px(_GAP) + max(imgui.get_frame_height(), px(17) + 2 * px(8))
        if session.editing:
            width = (len(TOOL_ICONS) + 1) * plain + px(_SEPARATOR)
            width += len(_FILES) * plain + px(_SEPARATOR) if plan.files else 0.0
            width += len(_HISTORY) * plain + px(_SEPARATOR) if plan.history else 0.0
            if plan.labels:
                words = [actions.BY_ID[f"tool.{tool}"].label for tool in TOOL_ICONS]
                width += sum(
                    imgui.calc_text_size(f"  {word}").x for word in map(tr, (*words, "Play"))
                )
        else:
            width = len(_TRANSPORT) * plain
        return width + (px(24) + self._right_width(session, plan) if plan.view else 0.0)

    def _tools(self, session: "Session", *, labels: bool) -> None:
        for index, (tool, icon) in enumerate(TOOL_ICONS.items()):
            if index:
                imgui.same_line(0, px(_GAP))
            name = actions.BY_ID[f"tool.{tool}"].label
            current = session.tool.id == tool
            action_button(
                session,
                f"tool.{tool}",
                icon,
                label=name if labels else "",
                on=current,
                tint=COLOURS.text if current or labels else None,
            )

    def _transport(self, session: "Session") -> None:
        tints = {"run.stop": COLOURS.bad, "run.pause": COLOURS.play}
        for index, (action, icon) in enumerate(_TRANSPORT):
            if index:
                imgui.same_line(0, px(_GAP))
            resting = action == "run.pause" and session.mode is not Mode.PLAYING
            sign = Icons.play if resting else icon
            action_button(session, action, sign, tint=tints.get(action, COLOURS.text))

    def _combo_width(self, plan: Plan) -> float:
        return px(_PHYSICS_WIDTH) if plan.physics else px(17 + 18) + imgui.get_frame_height()

    def _right_width(self, session: "Session", plan: Plan) -> float:
        second = self._combo_width(plan) + px(4) if physics.comparing(session) else 0.0
        button = max(imgui.get_frame_height(), px(17) + 2 * px(8))
        snapping = 2 * button + px(2 + 8) if session.editing and plan.snapping else 0.0
        return button + self._combo_width(plan) + px(4) + snapping + second

    def _right(self, session: "Session", plan: Plan, space: float) -> None:
        padding = imgui.get_style().window_padding.x
        imgui.same_line(space - self._right_width(session, plan) - padding)
        if session.editing and plan.snapping:
            action_button(session, "snap.smart", Icons.magnet)
            imgui.same_line(0, px(2))
            action_button(session, "view.grid", Icons.grid)
            imgui.same_line(0, px(8))
        imgui.set_next_item_width(self._combo_width(plan))
        options = [(name, f"{Icons.chip}  {name}") for name in self.physics]
        short = "" if plan.physics else Icons.chip
        current = session.playback.next_physics
        picked = widgets.choice(session, "physics", current, options, preview=short)
        if picked is not None:
            session.queue(lambda: physics.choose(session, picked))
        widgets.tooltip(
            f"Physics: {current}",
            "Preset or solver of the next episode. It never changes the level.",
        )
        imgui.same_line(0, px(4))
        action_button(session, "run.compare_physics", Icons.beside)
        if physics.comparing(session):
            imgui.same_line(0, px(4))
            imgui.set_next_item_width(self._combo_width(plan))
            self._second(session, options)

    def _second(self, session: "Session", options: list[tuple[str, str]]) -> None:
        """The physics beside the first one."""
        other = session.viewer.other_physics
        choices = [*options, ("", f"{Icons.close}  only one")]
        picked = widgets.choice(session, "physics.other", other, choices)
        if picked is not None:
            session.queue(lambda: physics.compare_with(session, picked))
        widgets.tooltip("The physics beside", "Plays the same level with the same keys.")
