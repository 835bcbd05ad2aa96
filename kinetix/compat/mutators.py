"""kinetix-env's mutations of levels, by our names for them."""

from collections.abc import Callable

from jaxtyping import Array

from kinetix.environment.generators.edits import mutate_state
from kinetix.environment.generators.params import UEDParams
from kinetix.environment.params import EnvParams, StaticEnvParams
from kinetix.environment.state import EnvState

MutateState = Callable[..., EnvState]
"""From key, state, the two records of parameters and `UEDParams` to a level."""


def _mutation(name: str) -> MutateState:
    def mutate(
        rng: Array,
        state: EnvState,
        env_params: EnvParams | None = None,
        static_env_params: StaticEnvParams | None = None,
        ued_params: UEDParams | None = None,
    ) -> EnvState:
        del env_params, static_env_params
        return mutate_state(rng, state, name, ued_params)

    mutate.__doc__ = f"Return the level with the mutation `{name}`; see `mutate_state`."
    return mutate


def mutate_add_shape(
    rng: Array,
    state: EnvState,
    env_params: EnvParams | None = None,
    static_env_params: StaticEnvParams | None = None,
    ued_params: UEDParams | None = None,
    force_no_fixate: bool = False,
) -> EnvState:
    """Return the level with a body more; where `force_no_fixate`, one that can move."""
    del env_params, static_env_params
    return mutate_state(rng, state, "add_shape", ued_params, force_no_fixate=force_no_fixate)


def mutate_add_connected_shape(
    rng: Array,
    state: EnvState,
    env_params: EnvParams | None = None,
    static_env_params: StaticEnvParams | None = None,
    ued_params: UEDParams | None = None,
    force_rjoint: bool = False,
) -> EnvState:
    """Return the level with a jointed body more; where `force_rjoint`, the joint is a hinge."""
    del env_params, static_env_params
    return mutate_state(rng, state, "add_connected_shape", ued_params, force_rjoint=force_rjoint)


mutate_add_connected_shape_proper = mutate_add_connected_shape
mutate_remove_shape = _mutation("remove_shape")
mutate_remove_joint = _mutation("remove_joint")
mutate_swap_role = _mutation("swap_role")
mutate_toggle_fixture = _mutation("toggle_fixture")
mutate_add_thruster = _mutation("add_thruster")
mutate_change_gravity = _mutation("change_gravity")
mutate_remove_thruster = _mutation("remove_thruster")
mutate_change_shape_location = _mutation("change_location")


def make_mutate_change_shape_size(
    env_params: EnvParams, static_env_params: StaticEnvParams
) -> MutateState:
    """Return the mutation that gives a body new dimensions."""
    del env_params, static_env_params
    return _mutation("change_size")


def make_mutate_change_shape_rotation(
    env_params: EnvParams, static_env_params: StaticEnvParams
) -> MutateState:
    """Return the mutation that turns a body."""
    del env_params, static_env_params
    return _mutation("change_rotation")
