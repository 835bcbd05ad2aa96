"""Rows of the Edit and the Arrange menu."""

from typing import Final

from editor.actions.base import Action, Context, editing, selecting
from editor.actions.editing import edit
from editor.session import Session

EDIT: Final = Context.EDIT


def _can_undo(session: Session) -> bool:
    under_way = session.driver.active or session.document.history.undo_label is not None
    return session.editing and under_way


def _can_redo(session: Session) -> bool:
    return session.editing and session.document.history.redo_label is not None


EDITS: Final = (
    Action(
        id="edit.undo",
        label="Undo",
        menu="Edit",
        group="undo",
        keys=("ctrl+z",),
        context=EDIT,
        enabled=_can_undo,
        refusal="There is nothing to undo.",
        run=edit.undo,
    ),
    Action(
        id="edit.redo",
        label="Redo",
        menu="Edit",
        group="undo",
        keys=("ctrl+shift+z", "ctrl+y"),
        context=EDIT,
        enabled=_can_redo,
        refusal="There is nothing to redo.",
        run=edit.redo,
    ),
    Action(
        id="edit.cut",
        label="Cut",
        menu="Edit",
        keys=("ctrl+x",),
        context=EDIT,
        enabled=selecting,
        run=edit.cut,
    ),
    Action(
        id="edit.copy",
        label="Copy",
        menu="Edit",
        keys=("ctrl+c",),
        context=EDIT,
        tooltip="Shapes with their joints and thrusters.",
        enabled=selecting,
        run=edit.copy,
    ),
    Action(
        id="edit.paste",
        label="Paste",
        menu="Edit",
        keys=("ctrl+v",),
        context=EDIT,
        tooltip="At the pointer.",
        enabled=editing,
        run=edit.paste,
    ),
    Action(
        id="edit.paste_properties",
        label="Paste Properties",
        menu="Edit",
        keys=("ctrl+shift+v",),
        context=EDIT,
        tooltip="Role, density, surface, motor, limits: everything but place and shape.",
        enabled=selecting,
        run=edit.paste_properties,
    ),
    Action(
        id="edit.duplicate",
        label="Duplicate",
        menu="Edit",
        keys=("ctrl+d",),
        context=EDIT,
        enabled=selecting,
        run=edit.duplicate,
    ),
    Action(
        id="edit.rename",
        label="Rename…",
        menu="Edit",
        group="more",
        keys=("f2",),
        context=EDIT,
        tooltip="A name for lists, messages and plots; it is saved in the level.",
        enabled=edit.can_rename,
        refusal="Select exactly one shape, joint or thruster.",
        run=edit.rename,
    ),
    Action(
        id="edit.select_all",
        label="Select All",
        menu="Edit",
        group="more",
        keys=("ctrl+a",),
        context=EDIT,
        enabled=editing,
        run=edit.select_all,
    ),
    Action(
        id="edit.delete",
        label="Delete",
        menu="Edit",
        group="more",
        keys=("delete", "backspace"),
        context=EDIT,
        tooltip="With its joints and thrusters.",
        enabled=selecting,
        run=edit.delete,
    ),
    Action(
        id="edit.cancel",
        label="Cancel",
        menu="Edit",
        group="more",
        keys=("escape",),
        context=EDIT,
        tooltip="Cancels the current operation; again: back to Select.",
        enabled=editing,
        run=edit.cancel,
    ),
)


ARRANGE: Final = (
    Action(
        id="edit.lock",
        label="Lock",
        menu="Arrange",
        keys=("ctrl+l",),
        context=EDIT,
        tooltip="Locked things are not picked, moved, turned or deleted.",
        enabled=selecting,
        run=edit.toggle_lock,
    ),
    Action(
        id="edit.hide",
        label="Hide",
        menu="Arrange",
        keys=("ctrl+h",),
        context=EDIT,
        tooltip="Only while editing; *Show Everything* brings it back.",
        enabled=selecting,
        run=edit.toggle_hide,
    ),
    Action(
        id="edit.show_all",
        label="Show Everything",
        menu="Arrange",
        keys=("alt+h",),
        context=EDIT,
        enabled=edit.has_hidden,
        refusal="Nothing is hidden.",
        run=edit.show_all,
    ),
    Action(
        id="edit.mirror_horizontal",
        label="Mirror Left–Right",
        menu="Arrange",
        group="mirror",
        keys=("ctrl+shift+h",),
        context=EDIT,
        enabled=selecting,
        run=edit.mirror("x"),
    ),
    Action(
        id="edit.mirror_vertical",
        label="Mirror Up–Down",
        menu="Arrange",
        group="mirror",
        keys=("ctrl+shift+u",),
        context=EDIT,
        enabled=selecting,
        run=edit.mirror("y"),
    ),
    *(
        Action(
            id=f"edit.align_{name}",
            label=label,
            menu="Arrange",
            group="align",
            context=EDIT,
            enabled=selecting,
            run=edit.align(label, axis, place),
        )
        for name, label, axis, place in (
            ("left", "Align Left", 0, lambda box: box[0]),
            ("centre_x", "Align Horizontal Centers", 0, lambda box: (box[0] + box[2]) / 2),
            ("right", "Align Right", 0, lambda box: box[2]),
            ("top", "Align Top", 1, lambda box: box[3]),
            ("centre_y", "Align Vertical Centers", 1, lambda box: (box[1] + box[3]) / 2),
            ("bottom", "Align Bottom", 1, lambda box: box[1]),
        )
    ),
    *(
        Action(
            id=f"edit.distribute_{name}",
            label=label,
            menu="Arrange",
            group="align",
            context=EDIT,
            tooltip="Equal gaps between three or more shapes; jointed ones count as one.",
            enabled=selecting,
            run=edit.distribute(label, axis),
        )
        for name, label, axis in (
            ("x", "Distribute Horizontally", 0),
            ("y", "Distribute Vertically", 1),
        )
    ),
    Action(
        id="edit.forward",
        label="Bring Forward",
        menu="Arrange",
        group="order",
        context=EDIT,
        enabled=selecting,
        run=edit.reorder(1),
    ),
    Action(
        id="edit.back",
        label="Send Back",
        menu="Arrange",
        group="order",
        context=EDIT,
        enabled=selecting,
        run=edit.reorder(-1),
    ),
    *(
        Action(
            id=f"transform.nudge_{name}",
            label=f"Nudge {name.capitalize()}",
            menu="Arrange",
            group="move",
            keys=(name,),
            variants=(f"shift+{name}", f"alt+{name}"),
            context=EDIT,
            tooltip="One step, as the preferences say; Shift: ten times as far, Alt: a tenth.",
            enabled=selecting,
            run=edit.nudge(x, y),
        )
        for name, x, y in (("left", -1, 0), ("right", 1, 0), ("up", 0, 1), ("down", 0, -1))
    ),
    *(
        Action(
            id=f"transform.{name}",
            label=label,
            menu="Arrange",
            group="move",
            keys=(key,),
            variants=variants,
            context=EDIT,
            tooltip=tooltip,
            enabled=selecting,
            run=edit.turn(degrees),
        )
        for name, label, key, variants, tooltip, degrees in (
            ("rotate_ccw", "Rotate Left 15°", "q", ("shift+q",), "Shift: 1°.", 15.0),
            ("rotate_cw", "Rotate Right 15°", "e", ("shift+e",), "Shift: 1°.", -15.0),
            ("rotate_ccw_45", "Rotate Left 45°", "[", (), "", 45.0),
            ("rotate_cw_45", "Rotate Right 45°", "]", (), "", -45.0),
        )
    ),
)
