"""JSON paths of an imported level's parts in the kinetix-env file that it came from."""

from typing import Final

from kinetix.engine.spec import ARENA_BODIES
from kinetix.level.kinetix_env.document import KinetixEnvDocument
from kinetix.level.model import ARENA_NAMES

# Native names of fields (in paths of faults) and what kinetix-env calls them.
_PEER_NAMES: Final[dict[str, str]] = {
    "angle": "rotation",
    "reference_angle": "rotation",
    "shape.vertices": "vertices",
    "shape.radius": "radius",
    "mass_properties.mass": "inverse_mass",
    "mass_properties.inertia": "inverse_inertia",
    "anchor_a": "a_relative_pos",
    "anchor_b": "b_relative_pos",
    "a": "a_index",
    "b": "b_index",
    "motor.speed": "motor_speed",
    "motor.power": "motor_power",
    "motor.binding": "motor_binding",
    "motor": "motor_on",
    "limits": "motor_has_joint_limits",
    "limits.min": "min_rotation",
    "limits.max": "max_rotation",
    "binding": "thruster_binding",
    "geometry.vertices": "vertices",
    "geometry.position": "position",
    "geometry": "vertices",
    "shape": "",
}
_WHOLE: Final = {
    "$.max_timesteps": "$.env_params.max_timesteps",
    "$.size": "$.static_env_params",
    "$.bodies": "$.env_state",
}


def body_place(document: KinetixEnvDocument, index: int) -> str:
    """Return the JSON path of a body by its slot, polygons first."""
    polygons = len(document.polygons)
    kind, slot = ("polygon", index) if index < polygons else ("circle", index - polygons)
    return f"$.env_state.{kind}[{slot}]"


def peer_places(document: KinetixEnvDocument) -> dict[str, str]:
    """Return the JSON paths of a level's parts, and those of the rows that they came from."""
    bodies = document.bodies
    rows = {
        "bodies": [
            body_place(document, k)
            for k, row in enumerate(bodies)
            if k >= ARENA_BODIES and row.active
        ],
        "joints": [
            f"$.env_state.joint[{k}]" for k, row in enumerate(document.joints) if row.active
        ],
        "thrusters": [
            f"$.env_state.thruster[{k}]"
            for k, row in enumerate(document.thrusters)
            if row.active and row.object_index >= ARENA_BODIES
        ],
    }
    places = {f"$.arena.{name}": body_place(document, k) for k, name in enumerate(ARENA_NAMES)}
    for kind, found in rows.items():
        places |= {f"$.{kind}[{k}]": place for k, place in enumerate(found)}
    return places


def peer_path(path: str, places: dict[str, str]) -> str:
    """Return the place in kinetix-env's file that a path in the imported level came from.

    Args:
        path: JSON path in the level.
        places: What `peer_places` gave.
    """
    for ours, theirs in places.items():
        if path == ours or path.startswith(f"{ours}."):
            field = path[len(ours) + 1 :]
            stem = field.split("[")[0]
            if stem == "position" and ours.startswith("$.thrusters"):
                renamed = "relative_position"
            else:
                renamed = _PEER_NAMES.get(stem, stem)
            inner = renamed + field[len(stem) :]
            return f"{theirs}.{inner}" if inner else theirs
    return _WHOLE.get(path, path.replace("$.gravity", "$.env_state.gravity"))
