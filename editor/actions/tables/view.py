"""Rows of the View menu."""

from typing import Final

from editor.actions import view
from editor.actions.base import Action, Context

EDIT: Final = Context.EDIT

VIEW: Final = (
    Action(
        id="snap.smart",
        label="Snap to Shapes",
        menu="View",
        keys=("shift+s",),
        context=EDIT,
        tooltip="Hold Ctrl while dragging to invert.",
        checked=view.is_set("snap_smart"),
        run=view.switch_setting("snap_smart"),
    ),
    Action(
        id="snap.grid",
        label="Snap to Grid",
        menu="View",
        keys=("shift+g",),
        context=EDIT,
        tooltip="Hold Ctrl while dragging to invert.",
        checked=view.is_set("snap_grid"),
        run=view.switch_setting("snap_grid"),
    ),
    Action(
        id="view.grid",
        label="Show Grid",
        menu="View",
        context=Context.LEVEL,
        keys=("g",),
        checked=view.is_set("grid_visible"),
        run=view.switch_setting("grid_visible"),
    ),
    Action(
        id="view.key_caps",
        label="Show Keys",
        menu="View",
        context=Context.LEVEL,
        tooltip="The keys that drive joints and thrusters, beside them.",
        checked=view.is_set("key_caps"),
        run=view.switch_setting("key_caps"),
    ),
    Action(
        id="view.minimap",
        label="Show Map",
        menu="View",
        context=Context.LEVEL,
        tooltip="The whole arena, small, in the corner; a click moves the view there.",
        checked=view.is_set("minimap"),
        run=view.switch_setting("minimap"),
    ),
    Action(
        id="view.frame_selection",
        label="Frame Selection",
        menu="View",
        context=Context.LEVEL,
        keys=("f",),
        run=view.frame_selection,
    ),
    Action(
        id="view.fit",
        label="Fit Arena",
        menu="View",
        keys=("home",),
        context=Context.LEVEL,
        run=view.fit,
    ),
    Action(
        id="view.actual_size",
        label="Actual Size",
        menu="View",
        context=Context.LEVEL,
        keys=("ctrl+0",),
        tooltip="100 pixels a metre.",
        run=view.actual_size,
    ),
    Action(
        id="view.toggle_ui",
        label="Show Panels",
        menu="View",
        keys=("tab",),
        tooltip="While a level is played they step aside; this brings them back.",
        checked=view.shows_panels,
        run=view.toggle_panels,
    ),
    Action(
        id="view.fullscreen",
        label="Full Screen",
        menu="View",
        keys=("f11",),
        checked=view.is_on("fullscreen"),
        run=view.switch("fullscreen"),
    ),
    Action(
        id="view.debug_draw",
        label="Debug Drawing",
        menu="View",
        context=Context.LEVEL,
        keys=("f3",),
        checked=view.is_on("debug_draw"),
        run=view.toggle_debug,
    ),
    Action(
        id="view.plots",
        label="Plots",
        menu="View",
        context=Context.LEVEL,
        keys=("f4",),
        checked=view.is_on("plots"),
        run=view.switch("plots"),
    ),
    *(
        Action(
            id=f"view.layout_{name}",
            label=f"Layout: {name.capitalize()}",
            menu="View",
            context=Context.LEVEL,
            tooltip=tooltip,
            run=view.lay_out(name),
        )
        for name, tooltip in (
            ("edit", "Outliner, level and inspector around the canvas."),
            ("play", "Timeline and plots under a wider canvas."),
            ("evaluate", "A high table of results."),
        )
    ),
    Action(
        id="view.keep_layout",
        label="Keep This Layout…",
        menu="View",
        context=Context.LEVEL,
        tooltip="Where the panels are now, under a name.",
        run=view.keep_layout,
    ),
    Action(
        id="view.next_tab",
        label="Next Tab",
        menu="View",
        keys=("ctrl+tab",),
        enabled=lambda session: len(session.tabs) > 1,
        refusal="Only one level is open.",
        run=view.switch_tab(1),
    ),
    Action(
        id="view.previous_tab",
        label="Previous Tab",
        menu="View",
        keys=("ctrl+shift+tab",),
        enabled=lambda session: len(session.tabs) > 1,
        refusal="Only one level is open.",
        run=view.switch_tab(-1),
    ),
)
