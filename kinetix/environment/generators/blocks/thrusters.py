"""Thrusters on bodies that are there."""

import math

import jax.numpy as jnp
from jaxtyping import Array, Bool, Int

from kinetix.engine.types import Thrusters
from kinetix.environment.generators.blocks.places import pick_figures, place_within
from kinetix.environment.generators.draws import ThrusterDraws, among, between, choose
from kinetix.environment.generators.figures import Figures, mass, pick
from kinetix.environment.generators.params import UEDParams
from kinetix.level.model import THRUSTER_BINDINGS


def thrusters_on(
    draws: ThrusterDraws,
    figures: Figures,
    eligible: Bool[Array, "b n"],
    ued: UEDParams,
    *,
    order: Int[Array, "k n"] | None = None,
    triangles: bool = False,
) -> tuple[Thrusters, Int[Array, "t n"]]:
    """Draw thrusters, each on one of the eligible bodies, and their channels.

    A thruster is inactive where no body is eligible.

    Args:
        draws: Uniform numbers for `t` thrusters.
        figures: The bodies.
        eligible: Which of them may carry one (they must be able to move).
        ued: The options.
        order: The slots to choose from, one after the other (−1: none); by default all of them.
        triangles: Whether there may be triangles among the bodies.
    """
    if order is not None:
        eligible = pick(eligible, order) & (order >= 0)
    body = choose(draws.body, eligible.astype(jnp.float32))
    body = body if order is None else pick(order, body)
    carrier = pick_figures(figures, body)
    turn = draws.place_x * (2 * math.pi)
    distance = draws.place_y * carrier.radius
    on_disc = jnp.stack([distance * jnp.cos(turn), distance * jnp.sin(turn)], axis=-2)
    within = place_within(
        carrier, draws.place_x, draws.place_y, triangles=triangles or ued.generate_triangles
    )
    position = jnp.where(carrier.circle[..., None, :], on_disc, within)
    x, y = position[..., 0, :], position[..., 1, :]
    outward = jnp.where((x == 0) & (y == 0), 0.0, jnp.arctan2(y, x))
    # One number for both: half of the aligned thrusters push inwards.
    inward = draws.angle >= 0.5
    aligned = jnp.where(inward, outward + math.pi, outward)
    along = draws.aligned < ued.thruster_align_com_prob
    push = ued.thruster_power_multiplier * between(draws.power, 0.5, 2.0)
    thrusters = Thrusters(
        body=body,
        position=position,
        angle=jnp.where(along, aligned, draws.angle * (2 * math.pi)),
        power=mass(carrier) * push,
        active=jnp.broadcast_to(jnp.any(eligible, axis=0, keepdims=True), x.shape),
    )
    return thrusters, among(draws.binding, THRUSTER_BINDINGS)
