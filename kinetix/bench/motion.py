"""Motion of a trial, and the quantities that follow from it: numpy only, for any engine."""

import dataclasses
import functools
import itertools
from typing import Final

import numpy as np
from jaxtyping import Bool, Float

from kinetix.level.geometry import arena_bodies, inverse_mass, referenced_body, to_world
from kinetix.level.graph import components, may_push
from kinetix.level.model import ARENA_NAMES, Body, BodyReference, Circle, Point, Polygon
from kinetix.scenes.model import Trial

WILD_DISTANCE: Final = 1e3
"""A body that strays farther from its start has left the scene [m]."""
WILD_SPEED: Final = 1e3
"""Faster than this is an explosion [m/s]."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Motion:
    """A recorded trial. Axis `k` is time with the start, `b` the level's bodies in order."""

    trial: Trial
    position: Float[np.ndarray, "k b 2"]
    rotation: Float[np.ndarray, "k b"]
    velocity: Float[np.ndarray, "k b 2"]
    angular_velocity: Float[np.ndarray, "k b"]
    overflow: float = 0.0
    """Share of the steps that met more contacts than the engine has room for."""

    @property
    def time(self) -> Float[np.ndarray, " k"]:
        """Times of the frames [s]."""
        return np.arange(len(self.position)) * self.trial.dt

    @property
    def bodies(self) -> tuple[Body, ...]:
        """In the order of the arrays."""
        return self.trial.level.bodies

    @functools.cached_property
    def wild_after(self) -> float | None:
        """Time at which the run broke: NaN, too far or too fast [s]; None if it never did."""
        with np.errstate(all="ignore"):
            distance = np.abs(self.position - self.position[0]).max(axis=(1, 2))
            speed = np.abs(self.velocity).max(axis=(1, 2))
            turning = np.isfinite(self.rotation).all(1) & np.isfinite(self.angular_velocity).all(1)
            good = (distance < WILD_DISTANCE) & (speed < WILD_SPEED) & turning
        return None if good.all() else float(self.time[np.argmin(good)])

    @functools.cached_property
    def masses(self) -> Float[np.ndarray, "b 2"]:
        """Mass [kg] and moment of inertia [kg m²] of every body; 0 for fixed ones."""
        model = self.trial.level.inertia_model
        inverses = np.array([inverse_mass(body, model) for body in self.bodies])
        return np.divide(1, inverses, out=np.zeros_like(inverses), where=inverses > 0)

    @property
    def free(self) -> Bool[np.ndarray, " b"]:
        """True for bodies that can move."""
        return self.masses[:, 0] > 0

    def kinetic_energy(self) -> Float[np.ndarray, " k"]:
        """Return the kinetic energy of all bodies [J]."""
        mass, inertia = self.masses.T
        return ((self.velocity**2).sum(-1) @ mass + self.angular_velocity**2 @ inertia) / 2

    def energy(self) -> Float[np.ndarray, " k"]:
        """Kinetic and potential energy of all bodies [J]."""
        potential = -(self.position @ np.array(self.trial.level.gravity)) @ self.masses[:, 0]
        return self.kinetic_energy() + potential

    def point(self, body: int, local: tuple[float, float]) -> Float[np.ndarray, "k 2"]:
        """Return the place of a body's point in the world [m].

        Args:
            body: Index into the level's bodies; negative counts from the end.
            local: The point in the body's frame.
        """
        return self.position[:, body] + turned(self.rotation[:, body], np.array(local))

    def joint_gap(self) -> Float[np.ndarray, "k j"]:
        """Return the gap between the two ends of every joint [m]."""
        gaps = []
        for joint in self.trial.level.joints:
            first = self._attached(joint.a, joint.anchor_a)
            second = self._attached(joint.b, joint.anchor_b)
            gaps.append(np.linalg.norm(second - first, axis=-1))
        return np.stack(gaps, axis=1) if gaps else np.zeros((len(self.position), 0))

    def penetration(self) -> Float[np.ndarray, " k"]:
        """Deepest overlap of any two bodies that push each other [m]; 0 where none does.

        Arena bodies that can be felt count too.
        """
        placed = self._placed()
        component = components(self.trial.level.joints)
        deepest = np.zeros(len(self.position))
        for first, second in itertools.combinations(placed, 2):
            if not may_push(
                (first.reference, first.body), (second.reference, second.body), component
            ):
                continue
            distance = np.linalg.norm(first.position - second.position, axis=-1)
            near = distance < first.reach + second.reach
            if near.any():
                gap = _separation(first.at(near), second.at(near))
                deepest[near] = np.maximum(deepest[near], -gap)
        return deepest

    def _placed(self) -> list["_Placed"]:
        """Return all bodies with their poses at every step, the arena's last."""
        moments = len(self.position)
        level = self.trial.level
        placed = [
            _Placed(
                reference=body.id,
                body=body,
                position=self.position[:, k],
                rotation=self.rotation[:, k],
            )
            for k, body in enumerate(level.bodies)
        ]
        for name, body in zip(ARENA_NAMES, arena_bodies(level.arena), strict=True):
            if body.collision != "ghost":
                place = np.broadcast_to(np.array(body.position, float), (moments, 2))
                placed.append(
                    _Placed(reference=name, body=body, position=place, rotation=np.zeros(moments))
                )
        return placed

    def _attached(self, body: BodyReference, anchor: Point) -> np.ndarray:
        level = self.trial.level
        for index, each in enumerate(level.bodies):
            if each.id == body:
                return self.point(index, anchor)
        return np.array(to_world(referenced_body(level, body), anchor))


@dataclasses.dataclass(frozen=True, kw_only=True)
class _Placed:
    """A body with its poses."""

    reference: BodyReference
    body: Body
    position: Float[np.ndarray, "k 2"]
    rotation: Float[np.ndarray, " k"]

    @property
    def reach(self) -> float:
        """Largest distance of a point of it from its origin [m]."""
        if isinstance(self.body.shape, Circle):
            return self.body.shape.radius
        return float(np.linalg.norm(np.array(self.body.shape.vertices), axis=-1).max())

    def at(self, moments: Bool[np.ndarray, " k"]) -> "_Placed":
        """Return the same at some of the moments."""
        return dataclasses.replace(
            self, position=self.position[moments], rotation=self.rotation[moments]
        )

    def corners(self) -> Float[np.ndarray, "k v 2"]:
        """Of a polygon, in the world [m]."""
        assert isinstance(self.body.shape, Polygon)
        local = np.array(self.body.shape.vertices)
        return self.position[:, None] + turned(self.rotation[:, None], local)


def _separation(first: _Placed, second: _Placed) -> Float[np.ndarray, " k"]:
    a, b = first.body.shape, second.body.shape
    if isinstance(a, Circle) and isinstance(b, Circle):
        distance = np.linalg.norm(first.position - second.position, axis=-1)
        return distance - a.radius - b.radius
    if isinstance(a, Circle):
        return outside(second.corners(), first.position) - a.radius
    if isinstance(b, Circle):
        return outside(first.corners(), second.position) - b.radius
    corners = first.corners(), second.corners()
    return np.maximum(most_apart(*corners), most_apart(*reversed(corners)))


def turned(angle: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Vectors turned counter-clockwise by angles [rad]; shapes broadcast over the last axis."""
    c, s = np.cos(angle)[..., None], np.sin(angle)[..., None]
    x, y = vector[..., :1], vector[..., 1:]
    return np.concatenate([c * x - s * y, s * x + c * y], axis=-1)


def _normals(corners: np.ndarray) -> np.ndarray:
    """Outward unit normals of counter-clockwise corners (k, v, 2)."""
    edge = np.roll(corners, -1, axis=1) - corners
    normal = np.stack([edge[..., 1], -edge[..., 0]], axis=-1)
    return normal / np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-12)


def most_apart(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return the largest separation along the normals of a; negative for an overlap."""
    away = np.einsum("kvd,kwd->kvw", _normals(a), b)
    own = np.einsum("kvd,kvd->kv", _normals(a), a)
    return (away.min(axis=2) - own).max(axis=1)


def outside(corners: np.ndarray, point: np.ndarray) -> np.ndarray:
    """Return the distance of a point to a convex polygon; negative inside."""
    offset = point[:, None] - corners
    inner = np.einsum("kvd,kvd->kv", _normals(corners), offset).max(axis=1)
    edge = np.roll(corners, -1, axis=1) - corners
    share = np.einsum("kvd,kvd->kv", offset, edge) / np.maximum((edge**2).sum(-1), 1e-24)
    nearest = offset - np.clip(share, 0, 1)[..., None] * edge
    return np.where(inner < 0, inner, np.linalg.norm(nearest, axis=-1).min(axis=1))
