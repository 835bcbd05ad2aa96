"""The controls: which key drives which motors and thrusters, live."""

from typing import TYPE_CHECKING

from imgui_bundle import imgui

from editor import widgets
from editor.look import COLOURS, Icons
from editor.panels.base import Panel
from editor.widgets import px
from kinetix.level.model import MOTOR_BINDINGS, THRUSTER_BINDINGS, Level

if TYPE_CHECKING:
    from editor.session import Session

_GLYPHS = {"left": "←", "right": "→", "up": "↑", "down": "↓"}


class ControlsPanel(Panel):
    """One row a channel: its keys, lit while held, and what it drives in this level."""

    id, title, icon = "controls", "Controls", Icons.controls

    def draw(self, session: "Session") -> None:
        """Draw the rows."""
        level = session.document.shown
        keys = session.control_keys
        drawn = False
        for channel in range(MOTOR_BINDINGS + THRUSTER_BINDINGS):
            driven = driven_by(level, channel)
            if not driven:
                continue
            drawn = True
            imgui.align_text_to_frame_padding()
            ordered = sorted((d.value, key) for key, d in keys.items() if d.channel == channel)
            for _, key in ordered:
                lit = key in session.held and not session.editing
                widgets.key_cap(_GLYPHS.get(key, key.upper()), lit=lit)
                imgui.same_line(0, px(4))
            imgui.same_line(px(72))
            names = [session.document.name_of(entity) for entity in driven]
            widgets.text(", ".join(names), COLOURS.muted)
            if imgui.is_item_hovered():
                session.highlighted = driven
        if not drawn:
            widgets.empty_state(
                Icons.controls,
                "Nothing to control",
                "Press J over two overlapping shapes for a motor, or H on a shape for a thruster.",
            )
        elif session.editing:
            widgets.small("Press Space to play, then hold these keys.")


def driven_by(level: Level, channel: int) -> tuple[int, ...]:
    """Ids of the joints or thrusters that a channel drives."""
    if channel >= MOTOR_BINDINGS:
        binding = channel - MOTOR_BINDINGS
        return tuple(t.id for t in level.thrusters if t.binding == binding)
    return tuple(
        joint.id
        for joint in level.joints
        if joint.kind == "revolute"
        and joint.motor is not None
        and joint.motor.on
        and not joint.motor.auto
        and joint.motor.binding == channel
    )
