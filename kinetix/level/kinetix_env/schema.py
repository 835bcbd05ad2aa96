"""The schema of kinetix-env's level JSON: records, blocks and the checks of reading (no meaning).

Everything is a table: the order of the keys is the order in published files.
"""

from collections.abc import Callable
from typing import Any, Final

import msgspec

from kinetix.engine.spec import ARENA_BODIES, Capacity
from kinetix.level.faults import FaultCollector, bounds_text
from kinetix.level.json_text import DuplicateKeys
from kinetix.level.limits import LARGEST_REAL
from kinetix.level.model import MAX_ENTITIES
from kinetix.level.sizes import SIZES

VERTEX_ROWS: Final = 4


class KinetixBody(msgspec.Struct, frozen=True, kw_only=True):
    """A row of `polygon` or `circle`, as stored; vectors are tuples."""

    position: tuple[float, float] = (0.0, 0.0)
    rotation: float = 0.0
    velocity: tuple[float, float] = (0.0, 0.0)
    angular_velocity: float = 0.0
    inverse_mass: float = 0.0
    inverse_inertia: float = 0.0
    friction: float = 1.0
    restitution: float = 0.0
    collision_mode: int = 1
    active: bool = False
    n_vertices: int = 0
    vertices: tuple[tuple[float, float], ...] = ((0.0, 0.0),) * VERTEX_ROWS
    radius: float = 0.0
    role: int = 0
    density: float = 1.0
    highlighted: bool = False


class KinetixJoint(msgspec.Struct, frozen=True, kw_only=True):
    """A row of `joint`, as stored."""

    a_index: int = 0
    b_index: int = 0
    a_relative_pos: tuple[float, float] = (0.0, 0.0)
    b_relative_pos: tuple[float, float] = (0.0, 0.0)
    global_position: tuple[float, float] = (256.0, 256.0)
    active: bool = False
    acc_impulse: tuple[float, float] = (0.0, 0.0)
    acc_r_impulse: float = 0.0
    motor_speed: float = 0.0
    motor_power: float = 0.0
    motor_on: bool = False
    motor_has_joint_limits: bool = False
    min_rotation: float = 0.0
    max_rotation: float = 0.0
    is_fixed_joint: bool = False
    rotation: float = 0.0
    motor_binding: int = 0


class KinetixThruster(msgspec.Struct, frozen=True, kw_only=True):
    """A row of `thruster`, as stored."""

    object_index: int = 0
    relative_position: tuple[float, float] = (0.0, 0.0)
    rotation: float = 0.0
    power: float = 0.0
    global_position: tuple[float, float] = (0.0, 0.0)
    active: bool = False
    thruster_binding: int = 0


class KinetixContact(msgspec.Struct, frozen=True, kw_only=True):
    """A row of the three contact lists, as stored."""

    normal: tuple[float, float] = (0.0, 0.0)
    penetration: float = 0.0
    collision_point: tuple[float, float] = (0.0, 0.0)
    active: bool = False
    acc_impulse_normal: float = 0.0
    acc_impulse_tangent: float = 0.0
    restitution_velocity_target: float = 0.0


ENV_PARAMS: Final[dict[str, Any]] = {
    "dt": 0.016666666666666666,
    "slop": 0.01,
    "baumgarte_coefficient_joints_v": 2.0,
    "baumgarte_coefficient_joints_p": 0.7,
    "baumgarte_coefficient_fjoint_av": 2.0,
    "baumgarte_coefficient_rjoint_limit_av": 5.0,
    "baumgarte_coefficient_collision": 0.2,
    "joint_stiffness": 0.6,
    "clip_position": 15,
    "clip_velocity": 100,
    "clip_angular_velocity": 50,
    "base_motor_speed": 6.0,
    "base_motor_power": 900.0,
    "base_thruster_power": 10.0,
    "motor_decay_coefficient": 0.1,
    "motor_joint_limit": 0.1,
    "base_friction": 0.4,
    "max_timesteps": 256,
    "pixels_per_unit": 100,
    "dense_reward_scale": 0.1,
    "num_shape_roles": 4,
}
"""The block `env_params` of every published level."""


def static_env_params(capacity: Capacity) -> dict[str, Any]:
    """Return the block `static_env_params` of a published level with this capacity."""
    return {
        "num_polygons": capacity.polygons,
        "num_circles": capacity.circles,
        "num_joints": capacity.joints,
        "num_thrusters": capacity.thrusters,
        "max_polygon_vertices": VERTEX_ROWS,
        "num_solver_iterations": 10,
        "solver_batch_size": 16,
        "do_warm_starting": True,
        "num_static_fixated_polys": ARENA_BODIES,
        "screen_dim": {"0": 500, "1": 500},
        "downscale": 4,
        "frame_skip": 2,
        "max_shape_size": 2,
        "num_motor_bindings": 4,
        "num_thruster_bindings": 2,
    }


_STATIC_RANGES: Final[dict[str, tuple[float, float]]] = {
    "num_solver_iterations": (0, 1000),
    "solver_batch_size": (1, 1024),
    "downscale": (1, 4096),
    "frame_skip": (1, 1000),
    "num_motor_bindings": (1, 64),
    "num_thruster_bindings": (1, 64),
}
"""Ranges that can be stepped and drawn; `screen_dim` has `LARGEST_SCREEN`."""
_PARAMETER_RANGES: Final[dict[str, tuple[float, float]]] = {
    "dt": (1e-6, 1.0),
    "pixels_per_unit": (1, 10_000),
}
LARGEST_SCREEN: Final = 8192
"""Most pixels of a picture's side."""


Reader = Callable[[Any, str, FaultCollector], Any]


def read_real(value: Any, path: str, faults: FaultCollector) -> float:
    """Read a finite number."""
    if type(value) not in (float, int):
        faults.expect("E006", path, "a number", value)
        return 0.0
    if not abs(value) <= LARGEST_REAL:
        faults.expect("E007", path, "a finite 32-bit number", value)
        return 0.0
    return float(value)


def read_integer(value: Any, path: str, faults: FaultCollector) -> int:
    """Return a whole number; reals such as 1.0 count."""
    if type(value) is float and value.is_integer() and abs(value) < 2**53:
        return int(value)
    if type(value) is not int:
        faults.expect("E006", path, "a whole number", value)
        return 0
    if abs(value) >= 2**31:
        faults.expect("E007", path, "-2147483648 < x < 2147483648", value)
        return 0
    return value


def read_flag(value: Any, path: str, faults: FaultCollector) -> bool:
    """A boolean; the numbers 0 and 1 count."""
    if type(value) is bool:
        return value
    if value in (0, 1) and type(value) in (int, float):
        return bool(value)
    faults.expect("E006", path, "true or false", value)
    return False


def read_array(value: Any, path: str, faults: FaultCollector) -> list[Any] | None:
    """The elements of an array, written as a list or as an object with keys "0", "1" and so on."""
    if isinstance(value, list):
        return value
    if not isinstance(value, dict):
        faults.expect("E006", path, "an array", value)
        return None
    if isinstance(value, DuplicateKeys):
        faults.add("E005", path, f'the key "{value.key}" stands twice')
        return None
    try:
        return [value[str(k)] for k in range(len(value))]
    except KeyError as error:
        faults.add(
            "E004", path, f"expected an array with the keys 0 to n-1, key {error} is missing"
        )
        return None


def read_point(value: Any, path: str, faults: FaultCollector) -> tuple[float, float]:
    """Read two reals."""
    if type(value) is dict and len(value) == 2:
        x, y = value.get("0"), value.get("1")
        if type(x) is float and type(y) is float and abs(x) < 1e30 and abs(y) < 1e30:
            return x, y  # the usual case, without paths
    items = read_array(value, path, faults)
    if items is None:
        return 0.0, 0.0
    if len(items) != 2:
        faults.expect("E006", path, "an array of 2", items)
        return 0.0, 0.0
    return read_real(items[0], f"{path}[0]", faults), read_real(items[1], f"{path}[1]", faults)


def read_vertices(value: Any, path: str, faults: FaultCollector) -> tuple[tuple[float, float], ...]:
    """Read four corners."""
    items = read_array(value, path, faults)
    if items is None:
        return ((0.0, 0.0),) * VERTEX_ROWS
    if len(items) != VERTEX_ROWS:
        faults.expect("E006", path, f"an array of {VERTEX_ROWS}", items)
        return ((0.0, 0.0),) * VERTEX_ROWS
    return tuple(read_point(item, f"{path}[{k}]", faults) for k, item in enumerate(items))


def read_size(value: Any, path: str, faults: FaultCollector) -> int:
    """Read the numbers of slots."""
    number = read_integer(value, path, faults)
    if not 0 <= number <= MAX_ENTITIES:
        faults.expect("E007", path, f"0 ≤ x ≤ {MAX_ENTITIES}", value)
        return 0
    return number


def read_steps(value: Any, path: str, faults: FaultCollector) -> int:
    """Read the length of an episode."""
    number = read_integer(value, path, faults)
    if not 1 <= number <= 100_000:
        faults.expect("E007", path, "1 ≤ x ≤ 100000", value)
        return 1
    return number


_BY_TYPE: dict[Any, Reader] = {float: read_real, int: read_integer, bool: read_flag}
_BY_NAME: dict[str, Reader] = {
    "vertices": read_vertices,
    "max_timesteps": read_steps,
    "screen_dim": read_point,
    **dict.fromkeys(
        ("position", "velocity", "a_relative_pos", "b_relative_pos", "global_position"), read_point
    ),
    **dict.fromkeys(("acc_impulse", "relative_position", "normal", "collision_point"), read_point),
    **dict.fromkeys(("num_polygons", "num_circles", "num_joints", "num_thrusters"), read_size),
}


def _readers(template: dict[str, Any]) -> dict[str, Reader]:
    return {name: _BY_NAME.get(name) or _BY_TYPE[type(value)] for name, value in template.items()}


_RECORDS: dict[type[Any], tuple[dict[str, Reader], frozenset[str]]] = {
    cls: (_readers(msgspec.structs.asdict(cls())), frozenset(optional))
    for cls, optional in (
        (KinetixBody, {"highlighted"}),
        (KinetixJoint, ()),
        (KinetixThruster, ()),
        (KinetixContact, ()),
    )
}
# Parameters are reals there wherever kinetix-env computes with them, even if a file has 15.
_PARAMETER_READERS: Final = {
    **_readers(dict.fromkeys(ENV_PARAMS, 0.0)),
    "num_shape_roles": read_integer,
}
_STATIC_READERS: Final = {**_readers(static_env_params(SIZES["s"])), "max_shape_size": read_real}


def read_keys(
    value: Any,
    path: str,
    faults: FaultCollector,
    readers: dict[str, Reader],
    optional: frozenset[str] = frozenset(),
) -> dict[str, Any]:
    """Return the values of an object with exactly these keys, each read by its own reader."""
    if not isinstance(value, dict):
        faults.expect("E006", path, "an object", value)
        return {}
    if isinstance(value, DuplicateKeys):
        faults.add("E005", path, f'the key "{value.key}" stands twice')
    for key in value:
        if key not in readers:
            faults.add("E005", f"{path}.{key[:60]}", "unknown key")
    made = {}
    for name, reader in readers.items():
        if name in value:
            made[name] = reader(value[name], f"{path}.{name}", faults)
        elif name not in optional:
            faults.add("E004", path, f'the key "{name}" is missing')
    return made


def read_record(value: Any, cls: type[Any], path: str, faults: FaultCollector) -> Any:
    """Return one row of a collection."""
    readers, optional = _RECORDS[cls]
    return cls(**read_keys(value, path, faults, readers, optional))


def read_rows(
    value: Any, cls: type[Any], count: int, path: str, faults: FaultCollector
) -> tuple[Any, ...]:
    """Return the first `count` rows of a collection; more are ignored, fewer are a fault."""
    rows = read_array(value, path, faults)
    if rows is None:
        return ()
    if len(rows) < count:
        faults.expect("E007", path, f"an array of at least {count}", rows)
    return tuple(
        read_record(row, cls, f"{path}[{k}]", faults) for k, row in enumerate(rows[:count])
    )


_ZERO_CONTACT = KinetixContact()


def read_contacts(
    value: Any, count: int, path: str, faults: FaultCollector
) -> tuple[KinetixContact, ...]:
    """A contact list; rows that equal the one before are not read again, as most are empty."""
    rows = read_array(value, path, faults)
    if rows is None:
        return ()
    if len(rows) < count:
        faults.expect("E007", path, f"an array of at least {count}", rows)
    previous: Any = None
    contact = _ZERO_CONTACT
    made = []
    for k, row in enumerate(rows[:count]):
        if type(row) is not dict or row != previous:
            contact = read_record(row, KinetixContact, f"{path}[{k}]", faults)
            previous = row
        made.append(contact)
    return tuple(made)


def read_parameters(value: Any, path: str, faults: FaultCollector) -> dict[str, Any]:
    """Read `env_params`; Kinetix.js may have `{"type": "size" | "full", …}` instead."""
    if _named_size(value, path, faults):
        return dict(ENV_PARAMS)
    block = value["params"] if _is_wrapped(value) else value
    parameters = read_keys(block, path, faults, _PARAMETER_READERS)
    if not faults.faults:
        _check_ranges(parameters, _PARAMETER_RANGES, path, faults)
    return parameters


def read_static(value: Any, path: str, faults: FaultCollector) -> dict[str, Any]:
    """Read `static_env_params`; Kinetix.js may have `{"type": "size" | "full", …}` instead."""
    size = _named_size(value, path, faults)
    if size is not None:
        return static_env_params(SIZES[size])
    block = value["params"] if _is_wrapped(value) else value
    static = read_keys(block, path, faults, _STATIC_READERS, frozenset({"downscale"}))
    if faults.faults:
        return static
    _check_ranges(static, _STATIC_RANGES, path, faults)
    for name, only in (
        ("max_polygon_vertices", VERTEX_ROWS),
        ("num_static_fixated_polys", ARENA_BODIES),
    ):
        if static.get(name, only) != only:
            faults.expect("E007", f"{path}.{name}", str(only), static[name])
    if static.get("num_polygons", ARENA_BODIES) < ARENA_BODIES:
        faults.expect("E007", f"{path}.num_polygons", f"x ≥ {ARENA_BODIES}", static["num_polygons"])
    return static


def _check_ranges(
    values: dict[str, Any],
    ranges: dict[str, tuple[float, float]],
    path: str,
    faults: FaultCollector,
) -> None:
    for name, (low, high) in ranges.items():
        if name in values and not low <= values[name] <= high:
            faults.expect("E007", f"{path}.{name}", bounds_text(low, high), values[name])
    for k, side in enumerate(values.get("screen_dim", ())):
        if not 1 <= side <= LARGEST_SCREEN:
            place = f"{path}.screen_dim[{k}]"
            faults.expect("E007", place, bounds_text(1, LARGEST_SCREEN), side)


def _is_wrapped(value: Any) -> bool:
    return isinstance(value, dict) and "type" in value and "params" in value


def _named_size(value: Any, path: str, faults: FaultCollector) -> str | None:
    """Return the size whose name stands for a block; None where the block itself is there."""
    if not _is_wrapped(value) or value["type"] == "full":
        return None
    size = value.get("size")
    for name in SIZES:
        if size == name:
            return name
    faults.expect("E007", f"{path}.size", f"one of {', '.join(SIZES)}", size)
    return next(iter(SIZES))
