"""The inspector: every property of what is selected, also of many things at once."""

from typing import TYPE_CHECKING, Any, Final

from imgui_bundle import imgui

from editor.actions.editing.edit import named
from editor.base.controls import key_caps
from editor.base.wording import counts, plain_name
from editor.documents.commands.base import EntityId
from editor.documents.commands.fields import SetField, selected_records
from editor.toolkit import widgets
from editor.toolkit.appearance import FONTS, Icons
from editor.toolkit.segments import segments
from editor.toolkit.widgets import px
from editor.window.panels import shape_fields
from editor.window.panels.base import Panel
from editor.window.panels.fields import Editor
from editor.window.panels.resets import SAVED
from editor.window.panels.texts import TextFields
from kinetix.level.model import (
    MAX_NAME,
    MOTOR_BINDINGS,
    THRUSTER_BINDINGS,
    ArenaBody,
    Body,
    Circle,
    Entity,
    Joint,
    Record,
    Thruster,
)

if TYPE_CHECKING:
    from editor.session import Session

ROLE_OPTIONS: Final = (
    ("none", "None"),
    ("green", f"{Icons.green} Green"),
    ("blue", f"{Icons.blue} Blue"),
    ("red", f"{Icons.red} Red"),
)
_COLLISION_OPTIONS: Final = (("normal", "Normal"), ("always", "Always"), ("ghost", "Ghost"))
_ROLE_HINT = "Green must touch blue and must not touch red."


class Inspector(Panel):
    """Edits the fields that the selected things have in common."""

    id, title, icon = "inspector", "Inspector", Icons.inspector

    def __init__(self) -> None:
        self._editor = Editor()
        self._texts = TextFields()

    def draw(self, session: "Session") -> None:
        """Draw the sections that fit the selection."""
        self._editor.begin(session)
        self._texts.begin()
        records = selected_records(session.document.shown, session.selection)
        if not records:
            widgets.empty_state(
                Icons.select,
                "Nothing selected",
                "Click a shape, joint or thruster to see and change its properties. "
                "Shift+click adds to the selection; Ctrl+A takes everything.",
            )
            return
        with widgets.disabled(not session.editing):
            self._heading(session, records)
            for kind, draw in (
                (Body, self._bodies),
                (Joint, self._joints),
                (Thruster, self._thrusters),
                (ArenaBody, self._surface),
            ):
                pairs = zip(session.selection, records, strict=True)
                chosen = [(entity, record) for entity, record in pairs if isinstance(record, kind)]
                if chosen:
                    self._editor.ids = tuple(entity for entity, _ in chosen)
                    draw(session, [record for _, record in chosen])

    def _heading(self, session: "Session", records: list[Record]) -> None:
        first, *others = session.selection
        with widgets.font(FONTS.bold, 17):
            only = records[0]
            if others:
                widgets.wrapped(counts(records))
            elif isinstance(only, Entity):
                widgets.wrapped(plain_name(only))
            else:
                widgets.wrapped(session.document.name_of(first))
        if isinstance(first, int) and not others:
            self._name(session, first)
        imgui.dummy((0, px(2)))

    def _name(self, session: "Session", entity: int) -> None:
        document = session.document
        only = document.level.entity(entity)

        def commit(name: str) -> None:
            session.queue(lambda: session.execute(named(document.level, entity, name), on=document))

        hint, shown = "Name, seen in lists and plots", only.name or ""
        self._texts.line(session, "inspector.name", shown, commit, hint=hint, longest=MAX_NAME)

    def _bodies(self, session: "Session", records: list[Record]) -> None:
        edit = self._editor
        if widgets.section("Role"):
            edit.options(session, "role", ROLE_OPTIONS)
            widgets.tooltip("Role", _ROLE_HINT)
        if widgets.section("Place"):
            with widgets.property_table("place") as opened:
                if opened:
                    widgets.row("Position")
                    edit.pair(session, "position")
                    self._number(session, "Angle", "angle", 0.0)
        if widgets.section("Shape"):
            self._shape(session, records)
        if widgets.section("Body"):
            self._body_rows(session)
        if widgets.section("Motion at the start"):
            with widgets.property_table("motion") as opened:
                if opened:
                    widgets.row("Velocity")
                    edit.pair(session, "velocity", default=(0.0, 0.0))
                    self._number(session, "Spin", "angular_velocity", 0.0)

    def _shape(self, session: "Session", records: list[Record]) -> None:
        bodies = [record for record in records if isinstance(record, Body)]
        polygons = [body for body in bodies if not isinstance(body.shape, Circle)]
        with widgets.property_table("shape") as opened:
            if not opened:
                return
            if len(polygons) < len(bodies):
                self._number(session, "Radius", "shape.radius")
            if polygons:
                shape_fields.size_rows(session, self._editor, polygons)
            shape_fields.mass_rows(session, bodies)
        if len(bodies) == 1 and polygons:
            opened = widgets.section("Corners", opened=False)
            widgets.probe(session, "inspector.corners")
            if not opened:
                return
            with widgets.property_table("corners") as opened:
                if opened:
                    shape_fields.corner_rows(session, self._editor, bodies[0])

    def _body_rows(self, session: "Session") -> None:
        edit = self._editor
        with widgets.property_table("body") as opened:
            if not opened:
                return
            widgets.row("Fixed", "Infinite mass: nothing moves it.")
            edit.switch(session, "fixed", default=False)
            self._number(session, "Density", "density", 1.0)
            self._number(session, "Friction", "friction", 1.0)
            self._number(session, "Bounciness", "restitution", 0.0)
            widgets.row("Collides", "Two bodies collide when one is Always or both are Normal.")
            edit.options(session, "collision", _COLLISION_OPTIONS, default="normal")

    def _number(self, session: "Session", label: str, path: str, default: Any = SAVED) -> None:
        widgets.row(label)
        with self._editor.resettable(session, (path,), default) as room:
            self._editor.field(session, path, width=room)

    def _joints(self, session: "Session", records: list[Record]) -> None:
        edit = self._editor
        if widgets.section("Joint"):
            edit.options(session, "kind", (("revolute", "Hinge"), ("fixed", "Weld")))
        hinges = [record for record in records if isinstance(record, Joint)]
        if len(hinges) == 1:
            with widgets.property_table("joint") as opened:
                if opened:
                    shape_fields.joint_rows(session, edit, hinges[0])
        if all(joint.kind == "fixed" for joint in hinges):
            widgets.small("A weld holds place and angle; motor and limits have no effect.")
            return
        if widgets.section("Motor"):
            self._motor(session)
        if widgets.section("Limits"):
            self._limits(session)

    def _motor(self, session: "Session") -> None:
        edit = self._editor
        with widgets.property_table("motor") as opened:
            if not opened:
                return
            widgets.row("Driven", "Whether the joint answers to a control.")
            edit.switch(session, "motor.on", default=SAVED)
            widgets.row("Key")
            self._binding(session, "motor.binding", MOTOR_BINDINGS, 0)
            self._number(session, "Speed", "motor.speed", 1.0)
            self._number(session, "Power", "motor.power", 1.0)
            widgets.row("Automatic", "Always driven at +1, whatever the keys say.")
            edit.switch(session, "motor.auto", default=False)

    def _limits(self, session: "Session") -> None:
        edit = self._editor
        with widgets.property_table("limits") as opened:
            if not opened:
                return
            widgets.row("Limited")
            edit.switch(session, "limits.on", default=SAVED)
            self._number(session, "Min", "limits.min", 0.0)
            self._number(session, "Max", "limits.max", 0.0)
            widgets.row("Reference angle", "Angle of B minus angle of A that counts as zero.")
            with edit.resettable(session, ("reference_angle",)) as room:
                edit.field(session, "reference_angle", width=room)

    def _thrusters(self, session: "Session", records: list[Record]) -> None:
        del records
        if not widgets.section("Thruster"):
            return
        with widgets.property_table("thruster") as opened:
            if not opened:
                return
            widgets.row("Key")
            self._binding(session, "binding", THRUSTER_BINDINGS, MOTOR_BINDINGS)
            self._number(session, "Power", "power", 1.0)
            self._number(session, "Direction", "angle", 0.0)
            widgets.row("Position", "In the body's own frame.")
            self._editor.pair(session, "position")

    def _binding(self, session: "Session", path: str, count: int, first: int) -> None:
        keys = session.control_keys
        options = [
            (binding, "".join(key_caps(first + binding, keys)) or str(binding))
            for binding in range(count)
        ]
        self._editor.options(session, path, options)

    def _surface(self, session: "Session", records: list[Record]) -> None:
        edit = self._editor
        if widgets.section("Role"):
            edit.options(session, "role", ROLE_OPTIONS)
        if widgets.section("Surface"):
            with widgets.property_table("surface") as opened:
                if opened:
                    self._number(session, "Friction", "friction", 1.0)
                    self._number(session, "Bounciness", "restitution", 0.0)
                    widgets.row("Collides")
                    edit.options(session, "collision", _COLLISION_OPTIONS, default="always")
        self._own_geometry(session, records)
        widgets.small("Floor, walls and ceiling cannot be moved or deleted.")

    def _own_geometry(self, session: "Session", records: list[Record]) -> None:
        """Draw the geometry of an arena part that a level brings with it: to be read only."""
        only = records[0] if len(records) == 1 else None
        geometry = only.geometry if isinstance(only, ArenaBody) else None
        if geometry is None or not widgets.section("Own geometry"):
            return
        with widgets.property_table("geometry") as opened:
            if opened:
                x, y = geometry.position
                widgets.row("Position")
                widgets.muted(f"{x:.4g}, {y:.4g} m")
                for k, (x, y) in enumerate(geometry.vertices, start=1):
                    widgets.row(f"Corner {k}")
                    widgets.muted(f"{x:.4g}, {y:.4g} m")
        widgets.probe(session, "inspector.geometry")
        widgets.small("This level has its own here; it is kept as it is.")


def role_segments(session: "Session", name: str, ids: tuple[EntityId, ...], current: Any) -> None:
    """The four roles as a row of buttons for any entities, selected or not."""
    picked = segments(session, name, ROLE_OPTIONS, current)
    if picked is not None:
        session.queue(SetField(ids=ids, field="role", value=picked[0]))
