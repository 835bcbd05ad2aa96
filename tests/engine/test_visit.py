"""Visiting slots in turn and together, against loops written out."""

import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.engine.solvers.visit import Targets, Twist, in_turn, together

BODIES, SLOTS, WORLDS = 4, 5, 3


def random_targets(shares):
    random = np.random.default_rng(0)
    body_a = random.integers(0, BODIES, (SLOTS, WORLDS))
    body_b = (body_a + 1 + random.integers(0, BODIES - 1, (SLOTS, WORLDS))) % BODIES
    counted = np.zeros((BODIES, WORLDS))
    for body in (body_a, body_b):
        np.add.at(counted, (body, np.arange(WORLDS)[None]), 1)

    def share(body):
        return counted[body, np.arange(WORLDS)[None]] if shares else np.ones(body.shape)

    return Targets(
        body_a=jnp.asarray(body_a, jnp.int32),
        body_b=jnp.asarray(body_b, jnp.int32),
        share_a=jnp.asarray(share(body_a), jnp.float32),
        share_b=jnp.asarray(share(body_b), jnp.float32),
    )


def random_twist():
    x, y, turn = np.random.default_rng(1).normal(size=(3, BODIES, WORLDS)).astype(np.float32)
    return Twist(x=jnp.asarray(x), y=jnp.asarray(y), turn=jnp.asarray(turn))


def meet(pull, a, b, memory):
    """Each body goes a part of the way to the other; the memory counts how far."""
    way = (b - a) * pull
    return way, way * jnp.float32(-1), memory + jnp.abs(way.x)


def test_in_turn_is_a_loop_over_the_slots():
    targets, start = random_targets(shares=False), random_twist()
    pull = jnp.asarray(np.random.default_rng(2).random((SLOTS, WORLDS)), jnp.float32)
    end, memory = in_turn(start, targets, pull, jnp.zeros((SLOTS, WORLDS)), meet)

    for field in ("x", "y", "turn"):
        values = np.array(getattr(start, field))
        for slot in range(SLOTS):
            for world in range(WORLDS):
                a = int(targets.body_a[slot, world])
                b = int(targets.body_b[slot, world])
                way = float(pull[slot, world]) * (values[b, world] - values[a, world])
                values[a, world] += way
                values[b, world] -= way
                if field == "x":
                    assert float(memory[slot, world]) == pytest.approx(abs(way), abs=1e-6)
        assert np.abs(np.asarray(getattr(end, field)) - values).max() < 1e-6


def test_together_averages_the_copies():
    targets, start = random_targets(shares=True), random_twist()
    pull = jnp.full((SLOTS, WORLDS), 0.5, jnp.float32)
    end, _ = together(start, targets, pull, jnp.zeros((SLOTS, WORLDS)), meet)
    for world in range(WORLDS):
        copies = [[] for _ in range(BODIES)]
        for slot in range(SLOTS):
            a, b = int(targets.body_a[slot, world]), int(targets.body_b[slot, world])
            middle = float(start.x[a, world] + start.x[b, world]) / 2
            copies[a].append(middle)
            copies[b].append(middle)
        for body in range(BODIES):
            wanted = np.mean(copies[body]) if copies[body] else float(start.x[body, world])
            assert float(end.x[body, world]) == pytest.approx(wanted, abs=1e-6)


def test_nothing_to_visit_changes_nothing():
    start = random_twist()
    none = jnp.zeros((0, WORLDS))
    empty = Targets(
        body_a=none.astype(jnp.int32), body_b=none.astype(jnp.int32), share_a=none, share_b=none
    )
    for visit in (in_turn, together):
        end, _ = visit(start, empty, none, none, meet)
        assert end is start
