"""The columns of the symbolic observations: every number that an agent sees, named once.

Widths, documentation and the editor's "what the agent sees" view come from these tables.
"""

import dataclasses
from typing import Final

from kinetix.engine.spec import ARENA_BODIES, Capacity
from kinetix.environment.params import EnvParams, StaticEnvParams
from kinetix.level.sizes import describe_capacity

ROLE_NAMES: Final = ("neutral", "green", "blue", "red")
KINDS: Final = ("polygon", "circle", "joint", "thruster")
"""Order of the kinds in the padded form's one-hot."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Feature:
    """One column of an observation."""

    name: str
    unit: str = ""
    """Unit in brackets' content, empty for flags and pure numbers."""
    meaning: str = ""


def _vector(name: str, unit: str, meaning: str) -> tuple[Feature, ...]:
    return tuple(Feature(name=f"{name}_{axis}", unit=unit, meaning=meaning) for axis in "xy")


def _one_hot(name: str, labels: tuple[str, ...], meaning: str) -> tuple[Feature, ...]:
    return tuple(Feature(name=f"{name}_{label}", meaning=meaning) for label in labels)


def _turn(name: str, meaning: str) -> tuple[Feature, ...]:
    return tuple(Feature(name=f"{part}_{name}", meaning=meaning) for part in ("sin", "cos"))


@dataclasses.dataclass(frozen=True, kw_only=True)
class Layout:
    """Sizes that decide how many rows and columns the observations have."""

    capacity: Capacity
    roles: int
    motor_bindings: int
    thruster_bindings: int
    max_timesteps: int
    """Time limit of levels without one; width of the blind form."""
    env_params: EnvParams
    """For the picture: pixels per metre."""
    static_env_params: StaticEnvParams
    """For the picture: its size."""

    def __repr__(self) -> str:
        """Name the size."""
        return f"<Layout: size {describe_capacity(self.capacity)}>"

    @classmethod
    def of(cls, env_params: EnvParams, static_env_params: StaticEnvParams) -> "Layout":
        """Return the layout of an environment."""
        return cls(
            capacity=static_env_params.capacity,
            roles=env_params.num_shape_roles,
            motor_bindings=static_env_params.num_motor_bindings,
            thruster_bindings=static_env_params.num_thruster_bindings,
            max_timesteps=env_params.max_timesteps,
            env_params=env_params,
            static_env_params=static_env_params,
        )

    @property
    def body(self) -> tuple[Feature, ...]:
        """Features that polygons and circles have in common."""
        roles = tuple(
            ROLE_NAMES[index] if index < len(ROLE_NAMES) else str(index)
            for index in range(self.roles)
        )
        return (
            *_vector("position", "m", "centre of mass in the world"),
            *_vector("velocity", "m/s", "velocity of the centre of mass"),
            Feature(name="inverse_mass", unit="1/kg", meaning="0 for a fixed body"),
            Feature(name="inverse_inertia", unit="1/(kg m²)", meaning="0 for a fixed body"),
            Feature(name="density", unit="kg/m²"),
            Feature(name="angular_velocity", unit="10 rad/s", meaning="tanh(rad/s / 10)"),
            *_one_hot("role", roles, "one-hot"),
            *_turn("rotation", "orientation"),
            Feature(name="friction"),
            Feature(name="restitution"),
        )

    @property
    def circle(self) -> tuple[Feature, ...]:
        """A circle's row."""
        return (
            *self.body,
            Feature(name="radius", unit="m"),
            Feature(name="is_circle", meaning="the constant 1"),
        )

    @property
    def polygon(self) -> tuple[Feature, ...]:
        """A polygon's row."""
        corners = [
            feature
            for corner in range(4)
            for feature in _vector(f"vertex_{corner}", "m", "in the body's frame, clockwise")
        ]
        return (
            *self.body,
            Feature(name="is_circle", meaning="the constant 0"),
            *corners,
            Feature(name="is_triangle", meaning="three corners; the fourth reads −1, −1"),
        )

    @property
    def joint(self) -> tuple[Feature, ...]:
        """A joint's row, seen from one of its bodies."""
        bindings = tuple(str(index) for index in range(self.motor_bindings))
        return (
            Feature(name="active"),
            Feature(name="is_weld"),
            *_vector("from_anchor", "m", "in the frame of the body it is seen from"),
            *_vector("to_anchor", "m", "in the frame of the other body"),
            *_turn("reference_angle", "relative angle that counts as zero"),
            Feature(name="motor_speed", unit="6 rad/s", meaning="0 for welds, as all that follows"),
            Feature(name="motor_power", unit="900 rad/s²"),
            Feature(name="motor_on"),
            Feature(name="has_limits"),
            *_one_hot("motor_binding", bindings, "one-hot action channel"),
            *_turn("limit_min", "0 without limits, as all that follows"),
            *_turn("limit_max", ""),
            *(
                Feature(
                    name=f"limit_{side}_from_reference",
                    unit="rad",
                    meaning="limit minus reference angle. The limit is measured from the reference "
                    "angle already, so this takes it off twice, as kinetix-env's observation does",
                )
                for side in ("min", "max")
            ),
        )

    @property
    def thruster(self) -> tuple[Feature, ...]:
        """A thruster's row."""
        bindings = tuple(str(index) for index in range(self.thruster_bindings))
        return (
            Feature(name="active"),
            *_vector("position", "m", "in the body's frame"),
            *_one_hot("thruster_binding", bindings, "one-hot action channel"),
            *_turn("angle", "relative to the body"),
            Feature(name="power", unit="10 N"),
        )

    @property
    def gravity(self) -> Feature:
        """The gravity feature, which all forms end with."""
        return Feature(name="gravity_y", unit="10 m/s²", meaning="vertical gravity / 10")

    def body_columns(self, name: str) -> tuple[Feature, ...]:
        """Return a one-hot over the bodies in global order."""
        labels = tuple(
            [f"polygon_{index}" for index in range(self.capacity.polygons)]
            + [f"circle_{index}" for index in range(self.capacity.circles)]
        )
        return _one_hot(name, labels, "one-hot over the bodies")

    @property
    def flat_polygons(self) -> tuple[int, ...]:
        """The polygons that the flat forms list: the floor, then those that are not the arena's."""
        return (0, *range(ARENA_BODIES, self.capacity.polygons))

    @property
    def flat_joint(self) -> tuple[Feature, ...]:
        """A joint's row in the flat forms, where the two bodies are columns."""
        return (*self.joint, *self.body_columns("from"), *self.body_columns("to"))

    @property
    def flat_thruster(self) -> tuple[Feature, ...]:
        """A thruster's row in the flat forms."""
        return (*self.thruster, *self.body_columns("body"))

    @property
    def flat(self) -> tuple[Feature, ...]:
        """Every entry of the flat form, in order, as `kind[index].name`."""
        capacity = self.capacity
        kinds = (
            ("polygon", self.flat_polygons, self.polygon),
            ("circle", range(capacity.circles), self.circle),
            ("joint", range(capacity.joints), self.flat_joint),
            ("thruster", range(capacity.thrusters), self.flat_thruster),
        )
        rows = [
            dataclasses.replace(feature, name=f"{kind}[{index}].{feature.name}")
            for kind, indexes, features in kinds
            for index in indexes
            for feature in features
        ]
        return (*rows, self.gravity)

    @property
    def padded_width(self) -> int:
        """Columns of the padded form before the kind and gravity."""
        rows = (self.polygon, self.circle, self.flat_joint, self.flat_thruster)
        return max(len(row) for row in rows)
