"""Edits of thrusters: adding one, aiming and moving it."""

import dataclasses
from collections.abc import Hashable

from kinetix.errors import CommandError
from kinetix.level.geometry import body_mass, to_local
from kinetix.level.limits import STRONGEST_THRUSTER
from kinetix.level.model import THRUSTER_BINDINGS, Body, InertiaModel, Level, Point, Thruster

HOVERS = 2.0
"""A new thruster is this many times as strong as its body is heavy."""
HOVER_POWER = 0.981
"""Power that carries one kilogram: 9.81 m/s² over the 10 N of power 1."""


def default_power(body: Body, inertia_model: InertiaModel) -> float:
    """Return the power of a new thruster: twice what lets the body hover, 1 on a fixed body."""
    if body.fixed:
        return 1.0
    mass, _ = body_mass(body, inertia_model)
    return min(max(round(HOVERS * HOVER_POWER * mass, 2), 0.05), STRONGEST_THRUSTER)


def next_binding(level: Level) -> int:
    """Return the first thruster channel that nothing uses yet, else the first."""
    used = {thruster.binding for thruster in level.thrusters}
    return next((k for k in range(THRUSTER_BINDINGS) if k not in used), 0)


@dataclasses.dataclass(frozen=True, kw_only=True)
class AddThruster:
    """Puts a thruster on a body."""

    body: int
    point: Point
    """Place of attachment, in the world [m]."""
    direction: float
    """Direction of the push on the body, in the world [rad]."""
    merge_key: Hashable | None = None

    @property
    def label(self) -> str:
        """Label of the edit in menus and history."""
        return "Add thruster"

    def apply(self, level: Level) -> Level:
        """Append the thruster.

        Raises:
            CommandError: The body does not exist.
        """
        try:
            body = level.body(self.body)
        except KeyError:
            raise CommandError("A thruster needs a body; the arena cannot carry one.") from None
        thruster = Thruster(
            id=level.next_id,
            body=body.id,
            position=to_local(body, self.point),
            angle=self.direction - body.angle,
            power=default_power(body, level.inertia_model),
            binding=next_binding(level),
        )
        return level.replace(thrusters=(*level.thrusters, thruster), next_id=level.next_id + 1)


@dataclasses.dataclass(frozen=True, kw_only=True)
class PlaceThruster:
    """Moves a thruster, on its body or to another, or turns it; None leaves a part as it is."""

    thruster: int
    point: Point | None = None
    """[m], in the world."""
    direction: float | None = None
    """[rad], in the world."""
    body: int | None = None
    """Body that it pushes from now on; it pushes the same way there."""
    merge_key: Hashable | None = None

    @property
    def label(self) -> str:
        """Label of aiming or moving."""
        return "Aim thruster" if self.point is None else "Move thruster"

    def apply(self, level: Level) -> Level:
        """Change the thruster.

        Raises:
            CommandError: The thruster does not exist.
        """
        if all(thruster.id != self.thruster for thruster in level.thrusters):
            raise CommandError(f"There is no thruster {self.thruster}.")
        return level.replace(
            thrusters=tuple(
                self._placed(level, t) if t.id == self.thruster else t for t in level.thrusters
            )
        )

    def _placed(self, level: Level, thruster: Thruster) -> Thruster:
        body = level.body(thruster.body)
        if self.body is not None and self.body != body.id:
            old, body = body, level.body(self.body)
            thruster = thruster.replace(body=body.id, angle=thruster.angle + old.angle - body.angle)
        if self.point is not None:
            thruster = thruster.replace(position=to_local(body, self.point))
        if self.direction is not None:
            thruster = thruster.replace(angle=self.direction - body.angle)
        return thruster
