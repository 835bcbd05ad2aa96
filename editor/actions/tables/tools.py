"""Rows of the Tools menu, and what is otherwise done by holding a key."""

from typing import Final

from editor.actions import view
from editor.actions.base import Action, Context, editing
from editor.actions.editing import edit, placing
from editor.documents.commands.parts import PARTS

EDIT: Final = Context.EDIT

PART_ACTIONS: Final = tuple(
    Action(
        id=f"part.{part}",
        label=f"Drop {'an' if label[0] in 'AEIOU' else 'a'} {label}",
        menu="Tools",
        group="parts",
        context=EDIT,
        tooltip=f"{tooltip} At the pointer.",
        enabled=editing,
        run=edit.drop(part),
    )
    for part, (label, tooltip, _) in PARTS.items()
)
"""Parts to build with."""


TOOL_ACTIONS: Final = (
    *(
        Action(
            id=f"tool.{tool}",
            label=label,
            menu="Tools",
            keys=(key,),
            context=EDIT,
            tooltip=tooltip,
            enabled=editing,
            checked=view.is_tool(tool),
            run=view.choose(tool),
        )
        for tool, label, key, tooltip in (
            ("select", "Select", "v", "Select, move, turn and resize."),
            ("rectangle", "Rectangle", "r", "Press the key twice to draw several."),
            ("circle", "Circle", "c", "Press the key twice to draw several."),
            ("triangle", "Triangle", "t", "Three clicks."),
            ("joint", "Joint", "j", "A hinge with a motor, where two shapes overlap."),
            ("weld", "Weld", "w", "Makes two overlapping shapes one."),
            ("thruster", "Thruster", "h", "Pushes a shape; drag where to."),
        )
    ),
    Action(
        id="tool.place",
        label="Place a Shape in the Middle",
        menu="Tools",
        keys=("return",),
        context=EDIT,
        variants=("enter",),
        tooltip="Places a shape of standard size with the current tool, without a mouse.",
        enabled=placing.can_place,
        refusal="Take Rectangle, Circle or Triangle first.",
        run=placing.place,
    ),
)


SWITCHES: Final = tuple(
    Action(
        id=action_id,
        label=label,
        menu=menu,
        group="switches",
        tooltip=tooltip,
        checked=view.is_set(setting),
        run=view.switch_setting(setting),
    )
    for action_id, label, menu, tooltip, setting in (
        ("tool.keep", "Keep Tool", "Tools", "Draw several things in a row.", "keep_tool"),
        (
            "tool.from_centre",
            "Draw from the Centre",
            "Tools",
            "What Alt does while a rectangle is drawn.",
            "from_centre",
        ),
        (
            "transform.move_jointed",
            "Move Jointed Shapes Together",
            "Arrange",
            "Alt while dragging moves one shape alone.",
            "move_jointed",
        ),
        (
            "run.restart_automatically",
            "Restart Automatically",
            "Run",
            "Restart one second after the end.",
            "restart_automatically",
        ),
    )
)
"""Switches for functions that otherwise need a held key, or that have none."""
