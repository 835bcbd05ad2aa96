"""What an engine did with a trial, and what can be read off it: numpy only, for any engine."""

import dataclasses
import functools
from typing import Final

import numpy as np
from jaxtyping import Bool, Float

from kinetix.engine.pairs import collision_matrix
from kinetix.level.geometry import inverse_mass, referenced_body, to_world
from kinetix.level.model import Body, BodyReference, Circle, Point, Polygon
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
        """[s]."""
        return np.arange(len(self.position)) * self.trial.dt

    @property
    def bodies(self) -> tuple[Body, ...]:
        """In the order of the arrays."""
        return self.trial.level.bodies

    @functools.cached_property
    def wild_after(self) -> float | None:
        """When the run broke: not a number, too far or too fast [s]; None if it never did."""
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
        """Which bodies can move."""
        return self.masses[:, 0] > 0

    def kinetic_energy(self) -> Float[np.ndarray, " k"]:
        """Of all bodies [J]."""
        mass, inertia = self.masses.T
        return ((self.velocity**2).sum(-1) @ mass + self.angular_velocity**2 @ inertia) / 2

    def energy(self) -> Float[np.ndarray, " k"]:
        """Kinetic and potential energy of all bodies [J]."""
        potential = -(self.position @ np.array(self.trial.level.gravity)) @ self.masses[:, 0]
        return self.kinetic_energy() + potential

    def point(self, body: int, local: tuple[float, float]) -> Float[np.ndarray, "k 2"]:
        """Where a point of a body is in the world [m].

        Args:
            body: Index into the level's bodies; negative counts from the end.
            local: The point in the body's frame.
        """
        return self.position[:, body] + turned(self.rotation[:, body], np.array(local))

    def joint_gap(self) -> Float[np.ndarray, "k j"]:
        """How far apart the two ends of every joint are [m]."""
        gaps = []
        for joint in self.trial.level.joints:
            first = self._attached(joint.a, joint.anchor_a)
            second = self._attached(joint.b, joint.anchor_b)
            gaps.append(np.linalg.norm(second - first, axis=-1))
        return np.stack(gaps, axis=1) if gaps else np.zeros((len(self.position), 0))

    def penetration(self) -> Float[np.ndarray, " k"]:
        """Deepest overlap of any two bodies that push each other [m]; 0 where none does."""
        level = self.trial.level
        index = {body.id: k for k, body in enumerate(level.bodies)}
        joints = [(index[j.a], index[j.b]) for j in level.joints if j.a in index and j.b in index]
        a, b = np.array(joints, dtype=int).reshape(-1, 2).T
        collides = collision_matrix(len(index), a, b, np.ones(len(joints), bool))
        deepest = np.zeros(len(self.position))
        reach = [_reach(body) for body in level.bodies]
        for i in range(len(level.bodies)):
            for j in range(i + 1, len(level.bodies)):
                first, second = level.bodies[i], level.bodies[j]
                if not collides[i, j] or not (self.free[i] or self.free[j]):
                    continue
                if "ghost" in (first.collision, second.collision):
                    continue
                distance = np.linalg.norm(self.position[:, i] - self.position[:, j], axis=-1)
                near = distance < reach[i] + reach[j]
                if near.any():
                    deepest[near] = np.maximum(deepest[near], -self._separation(i, j, near))
        return deepest

    def corners(self, body: int) -> Float[np.ndarray, "k v 2"]:
        """The corners of a polygon in the world [m]."""
        shape = self.bodies[body].shape
        assert isinstance(shape, Polygon)
        local = np.array(shape.vertices)
        return self.position[:, body, None] + turned(self.rotation[:, body, None], local)

    def _attached(self, body: BodyReference, anchor: Point) -> np.ndarray:
        level = self.trial.level
        for index, each in enumerate(level.bodies):
            if each.id == body:
                return self.point(index, anchor)
        return np.array(to_world(referenced_body(level, body), anchor))

    def _separation(self, i: int, j: int, chosen: Bool[np.ndarray, " k"]) -> np.ndarray:
        first, second = self.bodies[i].shape, self.bodies[j].shape
        if isinstance(first, Circle) and isinstance(second, Circle):
            distance = np.linalg.norm(self.position[chosen, i] - self.position[chosen, j], axis=-1)
            return distance - first.radius - second.radius
        if isinstance(first, Circle):
            return outside(self.corners(j)[chosen], self.position[chosen, i]) - first.radius
        if isinstance(second, Circle):
            return outside(self.corners(i)[chosen], self.position[chosen, j]) - second.radius
        a, b = self.corners(i)[chosen], self.corners(j)[chosen]
        return np.maximum(most_apart(a, b), most_apart(b, a))


def turned(angle: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Vectors turned counter-clockwise by angles [rad]; shapes broadcast over the last axis."""
    c, s = np.cos(angle)[..., None], np.sin(angle)[..., None]
    x, y = vector[..., :1], vector[..., 1:]
    return np.concatenate([c * x - s * y, s * x + c * y], axis=-1)


def _reach(body: Body) -> float:
    if isinstance(body.shape, Circle):
        return body.shape.radius
    return float(np.linalg.norm(np.array(body.shape.vertices), axis=-1).max())


def _normals(corners: np.ndarray) -> np.ndarray:
    """Outward unit normals of counter-clockwise corners (k, v, 2)."""
    edge = np.roll(corners, -1, axis=1) - corners
    normal = np.stack([edge[..., 1], -edge[..., 0]], axis=-1)
    return normal / np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-12)


def most_apart(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Largest separation along the normals of a: negative when no edge of a parts them."""
    away = np.einsum("kvd,kwd->kvw", _normals(a), b)
    own = np.einsum("kvd,kvd->kv", _normals(a), a)
    return (away.min(axis=2) - own).max(axis=1)


def outside(corners: np.ndarray, point: np.ndarray) -> np.ndarray:
    """Distance of a point to a convex polygon; negative inside."""
    offset = point[:, None] - corners
    inner = np.einsum("kvd,kvd->kv", _normals(corners), offset).max(axis=1)
    edge = np.roll(corners, -1, axis=1) - corners
    share = np.einsum("kvd,kvd->kv", offset, edge) / np.maximum((edge**2).sum(-1), 1e-24)
    nearest = offset - np.clip(share, 0, 1)[..., None] * edge
    return np.where(inner < 0, inner, np.linalg.norm(nearest, axis=-1).min(axis=1))
