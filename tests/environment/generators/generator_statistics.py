"""Statistics of many drafts, defined as those of kinetix-env's recorded sample."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from kinetix.engine.spec import ARENA_BODIES
from kinetix.environment.generators.contacts import count_contacts
from kinetix.environment.generators.draft import Draft, components

QUANTILES = (0, 5, 25, 50, 75, 95, 100)


def shares(values: np.ndarray) -> dict[str, float]:
    kinds, counts = np.unique(np.asarray(values), return_counts=True)
    return {
        str(kind): float(count / values.size) for kind, count in zip(kinds, counts, strict=True)
    }


def pushing_overlaps(draft: Draft) -> np.ndarray:
    """Pairs per level that overlap and would push each other apart."""

    @jax.jit
    def touching(draft: Draft) -> Any:
        rows = draft.figures.active.shape[0]

        def against(row: Any) -> Any:
            one = jax.tree.map(lambda leaf: leaf[row][None], draft.figures)
            return count_contacts(draft.figures, one) > 0

        return jnp.stack([against(row) for row in range(rows)])

    touch = np.asarray(touching(draft))
    label = np.asarray(components(draft.joints, touch.shape[0]))
    fixed, active = np.asarray(draft.figures.fixed), np.asarray(draft.figures.active)
    pushes = touch & (label[:, None] != label[None]) & ~(fixed[:, None] & fixed[None])
    pushes &= active[:, None] & active[None]
    upper = np.triu(np.ones(touch.shape[:2], bool), 1)[..., None]
    return (pushes & upper).sum(axis=(0, 1))


def statistics(draft: Draft) -> dict[str, Any]:
    f = draft.figures
    rows = np.arange(f.active.shape[0])[:, None] >= ARENA_BODIES
    active = np.asarray(f.active) & rows
    circle, fixed, role = (np.asarray(x) for x in (f.circle, f.fixed, f.role))
    polygons, circles = active & ~circle, active & circle
    joints, thrusters = draft.joints, draft.thrusters
    joined = np.asarray(joints.active)
    weld = np.asarray(joints.fixed)
    revolute = joined & ~weld
    on = np.asarray(joints.motor_on)
    limited = np.asarray(joints.limited)
    corner = np.abs(np.asarray(f.vertices)).max(axis=(1, 2))

    def quantiles(values: np.ndarray) -> list[float]:
        return [float(v) for v in np.percentile(values, QUANTILES)] if values.size else []

    return {
        "n": active.shape[1],
        "polygons": shares(polygons.sum(0)),
        "circles": shares(circles.sum(0)),
        "joints": shares(joined.sum(0)),
        "thrusters": shares(np.asarray(thrusters.active).sum(0)),
        "fixed_joint_share": float(weld[joined].mean()),
        "motor_on_share": float(on[revolute].mean()),
        "limits_share": float(limited[revolute].mean()),
        "fixated_share_polygons": float(fixed[polygons].mean()),
        "fixated_share_circles": float(fixed[circles].mean()),
        "roles_share": shares(role[active]),
        "floor_role": shares(role[0]),
        "circle_radius_quantiles_0_5_25_50_75_95_100": quantiles(np.asarray(f.radius)[circles]),
        "polygon_max_abs_vertex_quantiles": quantiles(corner[polygons]),
        "triangles_share": float((np.asarray(f.vertex_count)[polygons] == 3).mean()),
        "motor_speed_quantiles": quantiles(np.asarray(joints.motor_speed)[revolute]),
        "motor_power_quantiles": quantiles(np.asarray(joints.motor_power)[revolute]),
        "thruster_power_quantiles": quantiles(
            np.asarray(thrusters.power)[np.asarray(thrusters.active)]
        ),
        "pushing_overlaps_at_start": shares(pushing_overlaps(draft)),
        "revolutes": int(revolute.sum()),
        "joined": int(joined.sum()),
        "bodies": int(active.sum()),
        "polygon_bodies": int(polygons.sum()),
        "circle_bodies": int(circles.sum()),
    }
