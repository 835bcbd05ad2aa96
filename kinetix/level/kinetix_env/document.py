"""kinetix-env's level JSON (kinetix-env 3): the data of a file, slot by slot.

With the modules `kinetix_env_*` beside it, the only code that knows this format.
"""

import contextlib
import dataclasses
from typing import Any, Final

from kinetix.engine.pairs import pair_counts
from kinetix.engine.spec import Capacity
from kinetix.level.faults import EnoughFaults, FaultCollector, bounds_text, fail
from kinetix.level.json_text import DuplicateKeys, parse_json
from kinetix.level.kinetix_env.schema import (
    ENV_PARAMS,
    VERTEX_ROWS,
    KinetixBody,
    KinetixContact,
    KinetixJoint,
    KinetixThruster,
    read_array,
    read_contacts,
    read_parameters,
    read_point,
    read_rows,
    read_static,
)
from kinetix.level.model import (
    COLLISIONS,
    ROLES,
    Level,
    round_real,
)

STANDARD_GRAVITY: Final = (0.0, round_real(-9.81))
"""Gravity that kinetix-env's reader always uses, whatever a file has [m/s²]."""


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class KinetixEnvDocument:
    """A file of kinetix-env: its text, byte for byte, and its content slot by slot."""

    file: str
    """Name of the file, for messages."""
    text: str
    """The file as it was read; writing this again changes nothing."""
    polygons: tuple[KinetixBody, ...]
    circles: tuple[KinetixBody, ...]
    joints: tuple[KinetixJoint, ...]
    thrusters: tuple[KinetixThruster, ...]
    polygon_contacts: tuple[KinetixContact, ...]
    """Two for each polygon pair: entries 2i and 2i+1."""
    circle_polygon_contacts: tuple[KinetixContact, ...]
    circle_contacts: tuple[KinetixContact, ...]
    gravity: tuple[float, float]
    """Gravity of the file; the standard one if it has none [m/s²]."""
    parameters: dict[str, Any]
    """The block `env_params`."""
    static: dict[str, Any]
    """The block `static_env_params`."""

    @property
    def capacity(self) -> Capacity:
        """Slots of the file."""
        return Capacity(
            polygons=len(self.polygons),
            circles=len(self.circles),
            joints=len(self.joints),
            thrusters=len(self.thrusters),
        )

    @property
    def bodies(self) -> tuple[KinetixBody, ...]:
        """All bodies in global order: polygons, then circles."""
        return self.polygons + self.circles


def parse_kinetix_env(text: str, file: str = "text") -> KinetixEnvDocument:
    """Read a level of kinetix-env, checking keys, types, lengths, finiteness and indices.

    Args:
        text: The JSON text.
        file: Name for messages.

    Raises:
        LevelError: The text is bad; the sentence has file and JSON path.
    """
    return document_from_tree(parse_json(text, file), text, file)


def document_from_tree(tree: Any, text: str, file: str) -> KinetixEnvDocument:
    """Like `parse_kinetix_env`, for text that has been parsed already.

    Raises:
        LevelError: The content is bad; the sentence has file and JSON path.
    """
    faults = FaultCollector()
    document = None
    with contextlib.suppress(EnoughFaults):
        document = _read_document(tree, text, file, faults)
    if faults.faults or document is None:
        fail(file, faults.faults)
    return document


def _read_document(
    tree: Any, text: str, file: str, faults: FaultCollector
) -> KinetixEnvDocument | None:
    if not isinstance(tree, dict) or not isinstance(tree.get("env_state"), dict):
        faults.add("E002", "$", 'expected an object with the key "env_state"')
        return None
    for path, part in (("$", tree), ("$.env_state", tree["env_state"])):
        if isinstance(part, DuplicateKeys):
            faults.add("E005", f"{path}.{part.key[:60]}", "the key stands twice")
    for name in ("env_params", "static_env_params"):
        if name not in tree:
            faults.add("E004", "$", f'the key "{name}" is missing')
    if faults.faults:
        return None
    static = read_static(tree["static_env_params"], "$.static_env_params", faults)
    parameters = read_parameters(tree["env_params"], "$.env_params", faults)
    if faults.faults:
        return None
    state = tree["env_state"]
    capacity = Capacity(
        polygons=static["num_polygons"],
        circles=static["num_circles"],
        joints=static["num_joints"],
        thrusters=static["num_thrusters"],
    )
    content = _read_state(state, capacity, faults)
    if content is None:
        return None
    made = KinetixEnvDocument(file=file, text=text, parameters=parameters, static=static, **content)
    _check_rows(made, faults)
    return made


_STATE_KEYS = (
    "polygon",
    "circle",
    "joint",
    "thruster",
    "collision_matrix",
    "acc_rr_manifolds",
    "acc_cr_manifolds",
    "acc_cc_manifolds",
)


def _read_state(
    state: dict[str, Any], capacity: Capacity, faults: FaultCollector
) -> dict[str, Any] | None:
    path = "$.env_state"
    for name in _STATE_KEYS:
        if name not in state:
            faults.add("E004", path, f'the key "{name}" is missing')
    for name in state:
        if name not in _STATE_KEYS and name != "gravity":
            faults.add("E005", f"{path}.{name[:60]}", "unknown key")
    if faults.faults:
        return None
    rr, cr, cc = pair_counts(capacity)
    matrix = read_array(state["collision_matrix"], f"{path}.collision_matrix", faults)
    if matrix is not None and len(matrix) < capacity.bodies:
        faults.expect(
            "E007", f"{path}.collision_matrix", f"an array of at least {capacity.bodies}", matrix
        )
    gravity = state.get("gravity", list(STANDARD_GRAVITY))
    return {
        "polygons": read_rows(
            state["polygon"], KinetixBody, capacity.polygons, f"{path}.polygon", faults
        ),
        "circles": read_rows(
            state["circle"], KinetixBody, capacity.circles, f"{path}.circle", faults
        ),
        "joints": read_rows(state["joint"], KinetixJoint, capacity.joints, f"{path}.joint", faults),
        "thrusters": read_rows(
            state["thruster"], KinetixThruster, capacity.thrusters, f"{path}.thruster", faults
        ),
        "polygon_contacts": read_contacts(
            state["acc_rr_manifolds"], 2 * rr, f"{path}.acc_rr_manifolds", faults
        ),
        "circle_polygon_contacts": read_contacts(
            state["acc_cr_manifolds"], cr, f"{path}.acc_cr_manifolds", faults
        ),
        "circle_contacts": read_contacts(
            state["acc_cc_manifolds"], cc, f"{path}.acc_cc_manifolds", faults
        ),
        "gravity": read_point(gravity, f"{path}.gravity", faults),
    }


def _check_rows(document: KinetixEnvDocument, faults: FaultCollector) -> None:
    """Ranges of numbers that stand for something else, in rows that are in use."""
    ranges = (("role", 0, len(ROLES) - 1), ("collision_mode", 0, len(COLLISIONS) - 1))
    corners = ("n_vertices", 3, VERTEX_ROWS)
    for kind, rows, limits in (
        ("polygon", document.polygons, (*ranges, corners)),
        ("circle", document.circles, ranges),
    ):
        for k, body in enumerate(rows):
            for name, low, high in limits:
                value = getattr(body, name)
                if body.active and not low <= value <= high:
                    path = f"$.env_state.{kind}[{k}].{name}"
                    faults.expect("E007", path, bounds_text(low, high), value)
    for kind, rows, names, channels in (
        ("joint", document.joints, ("a_index", "b_index"), "motor_binding"),
        ("thruster", document.thrusters, ("object_index",), "thruster_binding"),
    ):
        for k, row in enumerate(rows):
            if row.active:
                _check_links(document, row, (*names, channels), f"$.env_state.{kind}[{k}]", faults)


def _check_links(
    document: KinetixEnvDocument,
    row: KinetixJoint | KinetixThruster,
    names: tuple[str, ...],
    path: str,
    faults: FaultCollector,
) -> None:
    """Indices of bodies, and the number of the action channel (the last name), of one row."""
    *indices, channel = names
    bodies = document.bodies
    for name, count in [(name, len(bodies)) for name in indices] + [
        (channel, document.static[f"num_{channel}s"])
    ]:
        value = getattr(row, name)
        if not 0 <= value < count:
            faults.expect("E007", f"{path}.{name}", f"0 ≤ x < {count}", value)
        elif name in indices and not bodies[value].active:
            faults.add("E009", f"{path}.{name}", f"expected a body in use, got slot {value}")


def lost_fields(level: Level, *, stem: str | None = None) -> tuple[str, ...]:
    """Return the parts of a level that kinetix-env's file cannot hold, or its reader ignores.

    Args:
        level: The document.
        stem: The name of the file to be written, without suffix.
    """
    told = (
        (any(j.motor and j.motor.auto for j in level.joints), "automatic motors"),
        (level.gravity != STANDARD_GRAVITY, "gravity"),
        (level.max_timesteps != ENV_PARAMS["max_timesteps"], "max_timesteps"),
        (stem is not None and level.name != stem, "name"),
        (bool(level.description), "description"),
        (bool(level.tags), "tags"),
        (level.solution is not None, "solution"),
        (level.unnamed() is not level, "names of shapes, joints and thrusters"),
        (level.inertia_model != "kinetix", "how masses follow from shapes (they stay as numbers)"),
    )
    return tuple(what for applies, what in told if applies)
