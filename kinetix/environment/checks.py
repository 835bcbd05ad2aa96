"""Checks of the arguments of `reset` and `step` while they are traced: one sentence each.

Types and shapes are known then, so a check costs nothing in a compiled step. Values are not: they
are looked at where a method is called from Python. Under `jit` what lies outside an action's
range is clipped, or counts as no action (`env.action_space().contains` tells).
"""

import dataclasses
import functools
from collections.abc import Mapping
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from kinetix.engine.pipeline import empty_cache
from kinetix.engine.spec import Capacity, Features
from kinetix.environment.actions.base import AbstractAction
from kinetix.environment.actions.checks import check_choice
from kinetix.environment.arguments import NUMBERS, is_array, kind_of
from kinetix.environment.bounds import check_numbers
from kinetix.environment.feature_check import check_features
from kinetix.environment.params import EnvParams, PhysicsEngine
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError
from kinetix.forks import refuse_forked_process
from kinetix.level.features import capacity_of_world
from kinetix.level.model import Level
from kinetix.level.sizes import describe_capacity

_SINGLE = -1
"""Length of what has no axis of worlds."""
_ORDER = "the order is step(key, state, action, env_params), reset(key, env_params, state)"


def check_params(env_params: Any, order: str = _ORDER) -> None:
    """Refuse what is no `EnvParams`.

    Args:
        env_params: The argument; None is allowed.
        order: Right order of the arguments, for the sentence.

    Raises:
        KinetixError: The value has another type, or a number out of range.
    """
    if env_params is None:
        return
    if not hasattr(env_params, "dense_reward_scale"):
        raise KinetixError(f"env_params: expected EnvParams, got {kind_of(env_params)}; {order}")
    if isinstance(env_params, EnvParams):
        for name, value in vars(env_params).items():
            if shape := getattr(value, "shape", ()):
                raise KinetixError(
                    f"env_params.{name}: expected a number, got shape {shape}; "
                    "jax.vmap(env.step, in_axes=(…, 0)) takes parameters for each world"
                )
        check_numbers(env_params)


def check_env(env: Any) -> None:
    """Refuse what is no environment, before something is wrapped around it.

    Raises:
        KinetixError: The value has no `step`.
    """
    if not callable(getattr(env, "step", None)):
        raise KinetixError(f"env: expected an environment, got {kind_of(env)}")


def check_worlds(arguments: Mapping[str, Any], devices: int) -> None:
    """Refuse arguments that are not one value per world.

    Args:
        arguments: Those with a leading axis of worlds, by name; the first tells how many there are.
        devices: How many devices share the worlds.

    Raises:
        KinetixError: An argument is not a batch or has another length, or the worlds cannot be
            shared.
    """
    worlds = 0
    for name, argument in arguments.items():
        refuse_what_is_no_array(name, argument)
        if isinstance(argument, list | tuple):
            raise KinetixError(f"{name}: expected an array, got a list: jnp.array makes one of it")
        leaves = jax.tree.leaves(argument)
        lengths = {len(leaf) if jnp.ndim(leaf) else _SINGLE for leaf in leaves}
        if lengths == {0}:
            raise KinetixError(f"{name}: expected one per world, got none")
        alone = len(lengths) != 1 or lengths == {_SINGLE}
        if alone or (name == "key" and _is_one_raw_key(argument)):
            hint = ": jax.random.split(key, n)" if name == "key" else ""
            raise KinetixError(f"{name}: expected one per world, got a single one{hint}")
        (length,) = lengths
        worlds = worlds or length
        if length != worlds:
            raise KinetixError(f"{name}: expected one per world, {worlds} of them, got {length}")
    if worlds % devices:
        more = -(-worlds // devices) * devices
        raise KinetixError(
            f"{worlds} worlds: expected a multiple of the {devices} devices, such as {more}"
        )


def check_static_params(static_env_params: Any, order: str) -> None:
    """Refuse what is no `StaticEnvParams`.

    Args:
        static_env_params: The argument.
        order: Right order of the arguments, for the sentence.

    Raises:
        KinetixError: The value has another type.
    """
    if not hasattr(static_env_params, "frame_skip"):
        kind = kind_of(static_env_params)
        raise KinetixError(f"static_env_params: expected StaticEnvParams, got {kind}; {order}")


def check_parts(reset_fn: Any, env_params: Any, static_env_params: Any) -> None:
    """Refuse what no environment can be made of.

    Raises:
        KinetixError: A level stands where its reset function belongs, or the two kinds of
            parameters are swapped.
    """
    if reset_fn is not None and not callable(reset_fn):
        raise KinetixError(
            f"reset_fn: expected a function, got {kind_of(reset_fn)}; levels become one by "
            "make_reset_fn_list_of_levels([…], static_env_params)"
        )
    order = "make_kinetix_env(action_type, observation_type, reset_fn, env_params, "
    order = f"the order is {order}static_env_params)"
    check_params(env_params, order)
    check_static_params(static_env_params, order)


def check_truth(name: str, value: Any) -> None:
    """Refuse what is neither true nor false, such as the word "no".

    Args:
        name: Of the argument.
        value: The argument.

    Raises:
        KinetixError: The value is not a truth value.
    """
    if not isinstance(value, bool | np.bool_):
        raise KinetixError(f"{name}={value!r}: expected True or False")


def check_key(
    key: Any, order: str = _ORDER, many: str = "jax.vmap(env.step) or jax.vmap(env.reset)"
) -> None:
    """Refuse what is no random key.

    Args:
        key: The argument.
        order: Right order of the arguments, for the sentence.
        many: What takes a batch, for the sentence.

    Raises:
        KinetixError: `key` is not a random key, or is a batch of keys.
    """
    kind = getattr(key, "dtype", None)
    typed = kind is not None and jnp.issubdtype(kind, jax.dtypes.prng_key)
    raw = kind is not None and kind == jnp.uint32
    if not typed and not raw:
        raise KinetixError(f"key: expected jax.random.key(seed), got {kind_of(key)}; {order}")
    if jnp.ndim(key) != (0 if typed else 1):
        raise KinetixError(
            f"key: expected one key, got an array of shape {jnp.shape(key)}: use {many}"
        )


def check_draw(key: Any) -> None:
    """Refuse what a reset function cannot draw with, or where it would wait for ever.

    Args:
        key: Its argument.

    Raises:
        KinetixError: `key` is not a random key, or is a batch, or the process was forked.
    """
    refuse_forked_process()
    check_key(key, "a reset function takes a key alone", "jax.vmap(reset_fn)")


def check_is_state(state: Any, order: str = _ORDER) -> None:
    """Refuse what is no `EnvState`.

    Args:
        state: The argument.
        order: Right order of the arguments, for the sentence.

    Raises:
        KinetixError: The value has another type.
    """
    if not isinstance(state, EnvState):
        inside = " (its field env_state is one)" if hasattr(state, "env_state") else ""
        raise KinetixError(f"state: expected an EnvState, got {kind_of(state)}{inside}; {order}")


def check_one_state(state: Any, many: str, order: str = _ORDER) -> None:
    """Refuse what is not one `EnvState`.

    Args:
        state: The argument.
        many: What takes a batch, for the sentence.
        order: Right order of the arguments, for the sentence.

    Raises:
        KinetixError: The value is not a state, or is a batch.
    """
    check_is_state(state, order)
    if shape := jnp.shape(state.timestep):
        raise KinetixError(f"state: expected one state, got a batch of shape {shape}: use {many}")


def check_size(state: EnvState, want: Capacity) -> None:
    """Refuse a state of other sizes than an environment's.

    Args:
        state: One state.
        want: The environment's.

    Raises:
        KinetixError: The state has other sizes.
    """
    have = capacity_of_world(state.world)
    if have != want:
        raise KinetixError(
            f"state: expected the sizes of the environment, {describe_capacity(want)} (polygons, "
            f"circles, joints, thrusters), got {describe_capacity(have)}: "
            "kinetix.environment.rearrange.expand_state makes a level larger"
        )


def check_state(
    state: Any,
    engine: PhysicsEngine,
    many: str = "jax.vmap(env.step, in_axes=(0, 0, 0, None))",
) -> None:
    """Refuse a state that an environment of these sizes and this physics cannot step.

    Args:
        state: The argument.
        engine: The environment's sizes and physics.
        many: What takes a batch, for the sentence.

    Raises:
        KinetixError: The value is not a state, is a batch, or has another size, precision or
            physics.
    """
    check_one_state(state, many)
    check_size(state, engine.spec.capacity)
    kinds = {leaf.dtype for leaf in jax.tree.leaves(state) if hasattr(leaf, "dtype")}
    reals = {kind for kind in kinds if jnp.issubdtype(kind, jnp.floating)}
    others = {jax.dtypes.canonicalize_dtype(kind) for kind in reals} - {jnp.dtype(jnp.float32)}
    if others:
        raise KinetixError(
            f"state: expected numbers in float32, got {', '.join(sorted(map(str, others)))}: "
            "jax.tree.map(lambda x, y: x.astype(y.dtype), state, env.reset(key)[1])"
        )
    if _form(state.physics.cache) != _cache_form(engine):
        raise KinetixError(
            "state: it was made for another physics than the environment's: start from "
            "env.reset(key, env_params, state), or load the level with "
            "load_from_json_file(path, physics=…)"
        )


def check_values(
    env: Any,
    actions: AbstractAction | None,
    arguments: tuple[Any, ...],
    named: Mapping[str, Any],
    *,
    batch: bool = False,
) -> None:
    """Refuse values that a compiled step cannot see, where it is called from Python.

    Args:
        env: An environment, or a wrapper around one.
        actions: What an action means; None: its values are not looked at.
        arguments: Positional arguments of its `step`, `reset` or `get_obs`.
        named: Keyword arguments of it.
        batch: True for an action a world; it is not waited for, as that would cost some percent.

    Raises:
        KinetixError: A parameter or a choice of the action is out of its range, or the level to
            start in has something that the environment's step leaves out.
    """
    for argument in (*arguments, *named.values()):
        if isinstance(argument, EnvParams):
            check_numbers(argument)
    # A state in the second place is that of `step`, looked at when its episode began.
    is_reset = len(arguments) == 2 and not named
    starts = (named.get("override_reset_state"), *arguments[1 if is_reset else 2 :])
    for start in starts:
        state = _of_environment(start)
        if isinstance(state, EnvState):
            static = getattr(env, "static_env_params", None)
            check_features(state.world, getattr(static, "features", Features()))
    action = named.get("action", arguments[2] if len(arguments) > 2 else None)
    if actions is not None and isinstance(action, NUMBERS) and not (batch and _takes_time(action)):
        check_choice(action, actions, batch=batch)


def _of_environment(state: Any) -> Any:
    """Return the environment's state within a wrapper's; anything else as it is."""
    while hasattr(state, "env_state"):
        state = state.env_state
    return state


def _takes_time(value: Any) -> bool:
    """Return whether an array is still computed, or lies on an accelerator or elsewhere."""
    if not isinstance(value, jax.Array):
        return False
    array: Any = value  # JAX's type leaves out `is_ready`
    here = array.is_fully_addressable and all(d.platform == "cpu" for d in array.devices())
    return not here or not array.is_ready()


def refuse_what_is_no_array(name: str, arguments: Any) -> None:
    """Refuse texts and other things that JAX cannot take.

    Args:
        name: What was called.
        arguments: A tree of its arguments.

    Raises:
        KinetixError: An argument is neither an array nor a number.
    """
    for leaf in jax.tree.leaves(arguments):
        if not is_array(leaf):
            foreign = hasattr(leaf, "__dlpack__") and not isinstance(leaf, np.ndarray)
            how = "; jax.numpy.from_dlpack takes it" if foreign else ""
            if isinstance(leaf, Level | str):
                how = "; kinetix.load_from_json_file(level) makes a state and parameters of it"
            raise KinetixError(
                f"{name}: expected arrays and numbers, got {leaf!r:.60}{how}; {_ORDER}"
            )


def fitted(state: EnvState, engine: PhysicsEngine) -> EnvState:
    """Return a state as the environment can step it: dtypes settled, the solver's memory its own.

    A state that was made for another solver keeps its bodies; its memory of contacts starts empty.

    Raises:
        KinetixError: `state` is not a state, is a batch of them, or has other capacities than the
            environment; the message says which of polygons, circles, joints, thrusters and by how
            much.
    """
    if not isinstance(state, EnvState):
        hint = "a reset function returns one, and so does kinetix.environment.reset.level_state"
        if isinstance(state, tuple) and any(isinstance(one, EnvState) for one in state):
            hint = "take the state out of it, as in state, static_env_params, env_params = …"
        raise KinetixError(
            f"expected the EnvState that an episode starts in, got {kind_of(state)}: {hint}"
        )
    if jnp.ndim(state.timestep):
        raise KinetixError(
            f"expected one level to start in, got a batch of shape {jnp.shape(state.timestep)}: "
            "use jax.vmap(env.reset, in_axes=(0, None, 0))"
        )
    have, need = capacity_of_world(state.world), engine.spec.capacity
    if have != need:
        raise KinetixError(f"the level does not fit the environment: {_difference(have, need)}")
    physics = state.physics
    if _form(physics.cache) != _cache_form(engine):
        cache = empty_cache(engine.spec, engine.solver)
        physics = dataclasses.replace(physics, cache=cache)
    return jax.tree.map(
        lambda x: jax.lax.convert_element_type(jnp.asarray(x), jnp.asarray(x).dtype),
        dataclasses.replace(state, physics=physics),
    )


def _is_one_raw_key(value: Any) -> bool:
    return getattr(value, "dtype", None) == jnp.uint32 and jnp.ndim(value) == 1


def _form(tree: Any) -> Any:
    return jax.tree.structure(tree), tuple(jnp.shape(leaf) for leaf in jax.tree.leaves(tree))


@functools.cache
def _cache_form(engine: PhysicsEngine) -> Any:
    return _form(empty_cache(engine.spec, engine.solver))


def _difference(have: Capacity, need: Capacity) -> str:
    kinds = ("polygons", "circles", "joints", "thrusters")
    parts = [
        f"it has {getattr(have, kind)} slots of {kind}, the environment {getattr(need, kind)}"
        for kind in kinds
        if getattr(have, kind) != getattr(need, kind)
    ]
    return "; ".join(parts) + " (kinetix.environment.rearrange.expand_state makes a level larger)"
