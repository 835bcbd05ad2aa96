"""Fields of the inspector that no single stored value stands behind: sizes, corners, places."""

from itertools import chain
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor.base.arithmetic import Change
from editor.documents.commands.base import Command
from editor.documents.commands.fields import alike
from editor.documents.commands.joints import MoveJoint, ReassignJoint
from editor.documents.commands.sizes import (
    SIDE_MAX,
    SIDE_MIN,
    Axis,
    ResetCorners,
    ResetExtent,
    SetCorner,
    SetExtent,
    extent,
)
from editor.editing.picking import joint_position
from editor.toolkit import widgets
from editor.window.panels.fields import Editor
from editor.window.panels.number_field import NumberField
from editor.window.panels.number_info import FieldInfo
from kinetix.level.geometry import body_mass, referenced_body, to_world, world_vertices
from kinetix.level.limits import FARTHEST
from kinetix.level.model import ARENA_NAMES, Body, BodyReference, Circle, Joint, Polygon

if TYPE_CHECKING:
    from editor.session import Session

_AXES: Final[tuple[tuple[Axis, str], ...]] = ((0, "x"), (1, "y"))
_PLACE: Final = FieldInfo(
    unit="m", low=-FARTHEST, high=FARTHEST, slider=(0.0, 5.0), step=0.01, description="In the world"
)


def size_rows(session: "Session", editor: Editor, bodies: list[Body]) -> None:
    """Rows for width and height of the polygons among the selected bodies."""
    polygons = [body for body in bodies if isinstance(body.shape, Polygon)]
    ids = tuple(body.id for body in polygons)
    for axis, label, name in ((0, "Width", "width"), (1, "Height", "height")):
        side: Axis = 0 if axis == 0 else 1
        info = FieldInfo(
            unit="m",
            low=SIDE_MIN,
            high=SIDE_MAX,
            slider=(0.05, 2.0),
            step=0.01,
            description=f"{label} along the shape's own axis; the middle stays",
        )

        def command(change: Change, side: Axis = side) -> Command:
            return SetExtent(ids=ids, axis=side, change=change)

        values = [extent(b.shape, side) for b in polygons if isinstance(b.shape, Polygon)]
        widgets.row(label)
        field = NumberField(
            name=f"inspector.{name}", values=tuple(values), info=info, command=command
        )
        back = _former(session, polygons, side)
        with editor.arrow(session, name, back, "Reset to what is saved") as room:
            editor.number(session, field, width=room)


def _former(session: "Session", bodies: list[Body], axis: Axis) -> ResetExtent | None:
    """Return the edit that brings back the saved width or height; None where nothing differs."""
    saved = session.document.saved
    known = {body.id: body.shape for body in saved.bodies} if saved is not None else {}
    rows = []
    for body in bodies:
        former = known.get(body.id)
        if not isinstance(former, Polygon) or not isinstance(body.shape, Polygon):
            continue
        if not alike(extent(body.shape, axis), extent(former, axis)):
            rows.append((body.id, extent(former, axis)))
    return ResetExtent(axis=axis, rows=tuple(rows)) if rows else None


def corner_rows(session: "Session", editor: Editor, body: Body) -> None:
    """Draw rows for the corners of one polygon, in the world."""
    back = _former_corners(session, body)
    for number, corner in enumerate(world_vertices(body)):
        widgets.row(f"Corner {number + 1}")
        with editor.arrow(session, f"corner.{number}", back, "Reset to what is saved") as room:
            _corner(session, editor, body, number, corner, room)


def _former_corners(session: "Session", body: Body) -> ResetCorners | None:
    """Return the edit that brings back the saved corners, all of them; None where none differs."""
    saved = session.document.saved
    former = next((each for each in saved.bodies if each.id == body.id), None) if saved else None
    if former is None or isinstance(former.shape, Circle) or isinstance(body.shape, Circle):
        return None
    now, before = body.shape.vertices, former.shape.vertices
    if len(now) == len(before) and all(map(alike, chain(*now), chain(*before))):
        return None
    return ResetCorners(body=body.id, shape=former.shape)


def _corner(
    session: "Session",
    editor: Editor,
    body: Body,
    number: int,
    corner: tuple[float, float],
    room: float,
) -> None:
    width = (room - imgui.get_style().item_spacing.x) / 2
    for axis, letter in _AXES:
        if axis:
            imgui.same_line()
        value = corner[axis]

        def command(change: Change, axis: Axis = axis, value: float = value) -> Command:
            return SetCorner(body=body.id, corner=number, axis=axis, value=change.of(value))

        field = NumberField(
            name=f"inspector.corner.{number}.{letter}",
            values=(value,),
            info=_PLACE,
            command=command,
        )
        editor.number(session, field, width=width, prefix=f"{letter}  ")


def mass_rows(session: "Session", bodies: list[Body]) -> None:
    """Rows with mass and inertia: they follow from shape and density."""
    model = session.document.shown.inertia_model
    masses = [(0.0, 0.0) if body.fixed else body_mass(body, model) for body in bodies]
    for k, label, unit, detail in (
        (0, "Mass", "kg", "Area times density."),
        (1, "Inertia", "kg m²", "About the center of mass."),
    ):
        values = [mass[k] for mass in masses]
        if all(body.fixed for body in bodies):
            words = "infinite"
        elif all(alike(value, values[0]) for value in values):
            words = f"{values[0]:.4g} {unit}"
        else:
            words = f"{sum(values):.4g} {unit} in all" if k == 0 else widgets.MIXED
        widgets.row(label, detail)
        imgui.align_text_to_frame_padding()
        widgets.text(words)
        widgets.probe(session, f"inspector.{label.lower()}")


def joint_rows(session: "Session", editor: Editor, joint: Joint) -> None:
    """Rows for the bodies of one joint and its place in the world."""
    level = session.document.shown
    known: tuple[BodyReference, ...] = (*(body.id for body in level.bodies), *ARENA_NAMES)
    options = [(str(each), session.document.name_of(each)) for each in known]
    for end in ("a", "b"):
        widgets.row(f"Body {end.upper()}", "The motor turns B counter-clockwise against A.")
        current = str(getattr(joint, end))
        picked = widgets.choice(session, f"inspector.body_{end}", current, options)
        if imgui.is_item_hovered():
            session.highlighted = (getattr(joint, end),)
        if picked is not None:
            chosen: BodyReference = known[[str(each) for each in known].index(picked)]
            session.queue(ReassignJoint(joint=joint.id, end=end, body=chosen))
    x, y = joint_position(level, joint)
    widgets.row("Position")
    back = _former_place(session, joint)
    with editor.arrow(session, "anchor_a", back, "Reset to what is saved") as room:
        width = (room - imgui.get_style().item_spacing.x) / 2
        for axis, letter in _AXES:
            if axis:
                imgui.same_line()

            def command(change: Change, axis: Axis = axis) -> Command:
                value = change.of((x, y)[axis])
                return MoveJoint(joint=joint.id, point=(value, y) if axis == 0 else (x, value))

            place = (x, y)[axis]
            field = NumberField(
                name=f"inspector.joint.{letter}", values=(place,), info=_PLACE, command=command
            )
            editor.number(session, field, width=width, prefix=f"{letter}  ")


def _former_place(session: "Session", joint: Joint) -> MoveJoint | None:
    """Return the edit that puts a joint back to its saved place on body A; None where it is there.

    Bodies may have moved since: both anchors go there, so that the joint stays in one piece.
    """
    level, saved = session.document.shown, session.document.saved
    former = next((each for each in saved.joints if each.id == joint.id), None) if saved else None
    if former is None or (former.a, former.b) != (joint.a, joint.b):
        return None
    if all(map(alike, joint.anchor_a, former.anchor_a)):
        return None
    point = to_world(referenced_body(level, joint.a), former.anchor_a)
    return MoveJoint(joint=joint.id, point=point)
