"""Small building blocks of the panels.

Every widget that a person can click notes its rectangle in `session.probe` under a stable id, so
that tests and replays can point at it by name.
"""

from editor.toolkit.widgets.arrangement import (
    ROW_LABEL,
    beside,
    beside_words,
    property_table,
    raised_window,
    row,
    section,
    separator_gap,
    spinner,
)
from editor.toolkit.widgets.base import Probe, coloured, disabled, font, probe, px
from editor.toolkit.widgets.buttons import (
    button,
    checkbox,
    choice,
    icon_button,
    icon_width,
    primary_button,
    sign,
)
from editor.toolkit.widgets.caps import draw_key_plate, key_cap, key_caps, width_of_caps
from editor.toolkit.widgets.words import (
    KIND_ICONS,
    MIXED,
    badge,
    broken,
    centred_lines,
    empty_state,
    fitted,
    input_line,
    kind_colour,
    muted,
    raw,
    small,
    text,
    tooltip,
    wrapped,
)

__all__ = [
    "KIND_ICONS",
    "MIXED",
    "ROW_LABEL",
    "Probe",
    "badge",
    "beside",
    "beside_words",
    "broken",
    "button",
    "centred_lines",
    "checkbox",
    "choice",
    "coloured",
    "disabled",
    "draw_key_plate",
    "empty_state",
    "fitted",
    "font",
    "icon_button",
    "icon_width",
    "input_line",
    "key_cap",
    "key_caps",
    "kind_colour",
    "muted",
    "primary_button",
    "probe",
    "property_table",
    "px",
    "raised_window",
    "raw",
    "row",
    "section",
    "separator_gap",
    "sign",
    "small",
    "spinner",
    "text",
    "tooltip",
    "width_of_caps",
    "wrapped",
]
