"""The controls: which key drives which motors and thrusters, live."""

from typing import TYPE_CHECKING

from imgui_bundle import imgui

from editor.base.controls import GLYPHS
from editor.base.language import tr
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, Icons
from editor.toolkit.widgets import px
from editor.window.hints import pressed
from editor.window.panels.base import Panel
from kinetix.level.controls import channels_in_use, driven_by

if TYPE_CHECKING:
    from editor.session import Session


class ControlsPanel(Panel):
    """One row a channel: its keys, lit while held, and what it drives in this level."""

    id, title, icon = "controls", "Controls", Icons.controls

    def draw(self, session: "Session") -> None:
        """Draw the rows of controls."""
        level = session.document.shown
        keys = session.control_keys
        used = channels_in_use(level)
        for channel in used:
            driven = driven_by(level, channel)
            imgui.align_text_to_frame_padding()
            ordered = sorted((d.value, key) for key, d in keys.items() if d.channel == channel)
            for _, key in ordered:
                lit = key in session.hands.held and not session.editing
                widgets.key_cap(GLYPHS.get(key, key.upper()), lit=lit)
                imgui.same_line(0, px(4))
            imgui.same_line(px(72))
            names = [session.document.name_of(entity) for entity in driven]
            widgets.text(", ".join(map(tr, names)), COLOURS.muted)
            if imgui.is_item_hovered():
                session.highlighted = driven
        if not used:
            widgets.empty_state(
                Icons.controls,
                "Nothing to control",
                "Press J over two overlapping shapes for a motor, or H on a shape for a thruster.",
            )
        elif session.editing:
            widgets.small(pressed(session, "run.play_human", "to play, then hold these keys."))
