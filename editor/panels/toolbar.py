"""The bar at the top: files, undo, tools, play, snapping, physics."""

from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor import actions, widgets
from editor.actions import physics
from editor.keys import label as chord_label
from editor.look import COLOURS, Icons, Rgba
from editor.physics import PHYSICS
from editor.playback import Mode
from editor.widgets import px

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


def chords(session: "Session", action_id: str) -> str:
    """The first chord of an action, for people; rebound keys count."""
    keys = actions.chords(session, actions.BY_ID[action_id])
    return chord_label(keys[0]) if keys else ""


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
    widgets.tooltip(action.label, action.tooltip, chords(session, action_id))


class Toolbar:
    """Not a dockable panel: one line under the menu."""

    def __init__(self) -> None:
        self._wanted = 0.0
        self.physics: tuple[str, ...] = PHYSICS
        """Names of the presets and solvers; the engine's own once it is loaded."""

    def draw(self, session: "Session") -> None:
        """Draw the bar into the current window; labels go when it is too narrow for them."""
        space = imgui.get_window_width()
        roomy = self._wanted <= space or self._wanted == 0.0
        start = imgui.get_cursor_pos_x()
        self._files(session)
        widgets.separator_gap()
        self._tools(session, labels=roomy)
        widgets.separator_gap()
        self._transport(session, labels=roomy)
        left = imgui.get_item_rect_max().x - imgui.get_window_pos().x - start
        self._right(session, space)
        if roomy:
            self._wanted = left + self._right_width(session) + px(40)

    def _files(self, session: "Session") -> None:
        for index, (action, icon) in enumerate(
            (
                ("file.new", Icons.new),
                ("file.open", Icons.open),
                ("file.save", Icons.save),
                ("edit.undo", Icons.undo),
                ("edit.redo", Icons.redo),
            )
        ):
            if action == "edit.undo":
                widgets.separator_gap()
            elif index:
                imgui.same_line(0, px(2))
            action_button(session, action, icon)

    def _tools(self, session: "Session", *, labels: bool) -> None:
        for index, (tool, icon) in enumerate(TOOL_ICONS.items()):
            if index:
                imgui.same_line(0, px(2))
            name = actions.BY_ID[f"tool.{tool}"].label
            current = session.tool.id == tool and session.editing
            action_button(
                session,
                f"tool.{tool}",
                icon,
                label=name if labels else "",
                on=current,
                tint=COLOURS.text if current or labels else None,
            )

    def _transport(self, session: "Session", *, labels: bool) -> None:
        if session.editing:
            action_button(
                session,
                "run.play_human",
                Icons.play,
                label="Play" if labels else "",
                tint=COLOURS.play,
            )
            return
        paused = session.mode is not Mode.PLAYING
        action_button(session, "run.stop", Icons.stop, tint=COLOURS.bad)
        for action, icon in (
            ("run.pause", Icons.play if paused else Icons.pause),
            ("run.step_back", Icons.step_back),
            ("run.step", Icons.step),
            ("run.reset", Icons.reset),
            ("run.slower", Icons.slower),
            ("run.faster", Icons.faster),
        ):
            imgui.same_line(0, px(2))
            action_button(
                session, action, icon, tint=COLOURS.play if action == "run.pause" else COLOURS.text
            )

    def _right_width(self, session: "Session") -> float:
        second = px(150) + px(4) if physics.comparing(session) else 0.0
        return 3 * imgui.get_frame_height() + px(150) + px(32) + second

    def _right(self, session: "Session", space: float) -> None:
        imgui.same_line(space - self._right_width(session) - imgui.get_style().window_padding.x)
        action_button(session, "snap.smart", Icons.magnet)
        imgui.same_line(0, px(2))
        action_button(session, "view.grid", Icons.grid)
        imgui.same_line(0, px(8))
        imgui.set_next_item_width(px(150))
        options = [(name, f"{Icons.chip}  {name}") for name in self.physics]
        picked = widgets.choice(session, "physics", session.playback.physics, options)
        if picked is not None:
            session.queue(lambda: physics.choose(session, picked))
        widgets.tooltip(
            "Physics", "Preset or solver of the next episode. It never changes the level."
        )
        imgui.same_line(0, px(4))
        action_button(session, "run.compare_physics", Icons.beside)
        if physics.comparing(session):
            imgui.same_line(0, px(4))
            imgui.set_next_item_width(px(150))
            self._second(session, options)

    def _second(self, session: "Session", options: list[tuple[str, str]]) -> None:
        """The physics beside the first one."""
        other = session.viewer.other_physics
        choices = [*options, ("", f"{Icons.close}  only one")]
        picked = widgets.choice(session, "physics.other", other, choices)
        if picked is not None:
            session.queue(lambda: physics.compare_with(session, picked))
        widgets.tooltip("The physics beside", "Plays the same level with the same keys.")
