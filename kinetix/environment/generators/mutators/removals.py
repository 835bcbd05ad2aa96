"""Mutations that take something away."""

import dataclasses

from kinetix.engine.spec import Capacity
from kinetix.environment.generators.draft import Draft, hit
from kinetix.environment.generators.figures import pick
from kinetix.environment.generators.mutators.picking import (
    Marks,
    Numbers,
    ends,
    one_body,
    some,
    with_figures,
)
from kinetix.environment.generators.params import UEDParams


def remove_shape(
    draft: Draft, numbers: Numbers, marked: Marks, ued: UEDParams, capacity: Capacity
) -> Draft:
    """Take away a body with its joints and thrusters."""
    del ued, capacity
    _, gone = one_body(draft, numbers[0], marked)
    at_a, at_b = ends(draft.joints, gone)
    thrusters, joints = draft.thrusters, draft.joints
    loose = pick(gone, thrusters.body)
    return dataclasses.replace(
        with_figures(draft, active=draft.figures.active & ~gone),
        joints=dataclasses.replace(joints, active=joints.active & ~(at_a | at_b)),
        thrusters=dataclasses.replace(thrusters, active=thrusters.active & ~loose),
    )


def remove_joint(
    draft: Draft, numbers: Numbers, marked: Marks, ued: UEDParams, capacity: Capacity
) -> Draft:
    """Take away a joint."""
    del ued, capacity
    active = draft.joints.active
    gone = hit(active, some(active, numbers[0]), marked)
    return dataclasses.replace(
        draft, joints=dataclasses.replace(draft.joints, active=active & ~gone)
    )


def remove_thruster(
    draft: Draft, numbers: Numbers, marked: Marks, ued: UEDParams, capacity: Capacity
) -> Draft:
    """Take away a thruster."""
    del ued, capacity
    active = draft.thrusters.active
    gone = hit(active, some(active, numbers[0]), marked)
    return dataclasses.replace(
        draft, thrusters=dataclasses.replace(draft.thrusters, active=active & ~gone)
    )
