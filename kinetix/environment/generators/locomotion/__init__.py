"""The locomotion family: a body on limbs, driven to a goal."""

import functools
from collections.abc import Callable

from jaxtyping import Array, Key, UInt

from kinetix.environment.generators.draft import states
from kinetix.environment.generators.draws import sampler_of
from kinetix.environment.generators.locomotion.levels import draw_locomotion
from kinetix.environment.generators.locomotion.params import LocomotionParams
from kinetix.environment.generators.params import UEDParams
from kinetix.environment.params import PhysicsEngine
from kinetix.environment.state import EnvState

__all__ = ["LocomotionParams", "draw_locomotion", "locomotion_sampler"]


@functools.cache
def locomotion_sampler(
    engine: PhysicsEngine,
    params: LocomotionParams | None = None,
    ued: UEDParams | None = None,
) -> Callable[[Key[Array, ""]], EnvState]:
    """Return the function from a key to a locomotion level, to be used under jit and vmap.

    Args:
        engine: Sizes and solver.
        params: The options; None for the defaults.
        ued: Only for the floor's role.
    """
    options = params or LocomotionParams()

    def batched(keys: UInt[Array, "n 2"]) -> EnvState:
        draft = draw_locomotion(keys, engine.spec.capacity, options, ued)
        return states(draft, engine, options.inertia_model)

    return sampler_of(batched)
