"""Methods that compile quickly when they are called by themselves, and thoroughly inside of others.

A person who calls `env.step` from Python waits for the compiler first and mostly for Python from
then on: code that compiles in a quarter of the time and runs up to four times slower serves better.
Inside of `jit`, `vmap` and their like the caller's program is compiled, as thoroughly as any.
"""

import functools
import inspect
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from typing import Any, Final

import jax
from jax.extend.core import get_opaque_trace_state

from kinetix.compiler import quick_options
from kinetix.engine.promotion import usual_promotion
from kinetix.environment.actions.checks import with_usual_action
from kinetix.environment.checks import check_values, refuse_what_is_no_array
from kinetix.environment.mesh_check import refuse_mesh
from kinetix.environment.params import EnvParams
from kinetix.forks import refuse_forked_process
from kinetix.programs import make_room

_QUICK: Final = dict(quick_options())
"""Options of a program for a processor."""
_OUTSIDE: Final = get_opaque_trace_state("flax")
"""JAX's state while nothing is traced."""


def quick_alone(method: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a method quickly for calls from Python, and thoroughly as part of a larger program.

    The two may round differently. On a GPU or a TPU both are compiled thoroughly.

    Args:
        method: Takes a hashable `self` and pytrees of arrays.

    Returns:
        The compiled method, under `jax.disable_jit` too; it raises a KinetixError where an argument
        holds no arrays, or a value that cannot be.
    """
    inside = jax.jit(method, static_argnums=0)
    alone = jax.jit(method, static_argnums=0, compiler_options=_QUICK)
    names = [*inspect.signature(method).parameters][1:]
    place = names.index("env_params") if "env_params" in names else len(names)

    @functools.wraps(method)
    def call(self: Any, *arguments: Any, **named: Any) -> Any:
        outside = get_opaque_trace_state("flax") == _OUTSIDE
        refuse_mesh(arguments, named)
        if outside:
            refuse_forked_process()
            make_room()
            check_values(self, getattr(self, "actions", None), arguments, named)
            arguments, named = with_usual_action(arguments, named)
            arguments, named = _without_own(self, place, arguments, named)
        program = alone if outside and jax.default_backend() == "cpu" else inside
        # Step by step a solver would take minutes: `jax.disable_jit` is for the caller's own code.
        compiled = jax.disable_jit(False) if jax.config.values["jax_disable_jit"] else nullcontext()
        naming = _naming_what_is_no_array(method, (arguments, named))
        with compiled, usual_promotion(), naming:
            return program(self, *arguments, **named)

    return call


def thorough(method: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a method thoroughly, also for calls from Python: for many worlds at once.

    Args:
        method: Takes a hashable `self` with `check_values` and pytrees of arrays.

    Returns:
        The compiled method; it raises a KinetixError where an argument holds no arrays, or a value
        that cannot be.
    """
    program = jax.jit(method, static_argnums=0)

    @functools.wraps(method)
    def call(self: Any, *arguments: Any, **named: Any) -> Any:
        refuse_forked_process()
        make_room()
        refuse_mesh(arguments, named)
        if get_opaque_trace_state("flax") == _OUTSIDE:
            self.check_values(arguments, named)
        with usual_promotion(), _naming_what_is_no_array(method, (arguments, named)):
            return program(self, *arguments, **named)

    return call


def _without_own(
    env: Any, place: int, arguments: tuple[Any, ...], named: dict[str, Any]
) -> tuple[tuple[Any, ...], dict[str, Any]]:
    """Drop `env_params` that equal the environment's own: both calls share one program.

    Args:
        env: The method's environment.
        place: Where the parameters stand among the arguments.
        arguments: Positional arguments of the call.
        named: Keyword arguments of the call.
    """
    given = named.get("env_params", arguments[place] if place < len(arguments) else None)
    try:
        own = given is None or (isinstance(given, EnvParams) and given == env.env_params)
        hash(given)
    except (TypeError, ValueError):  # arrays
        own = False
    if not own:
        return arguments, named
    rest = arguments[place + 1 :]
    told = any(each is not None for each in rest)
    arguments = (*arguments[:place], None, *rest) if told else arguments[:place]
    return arguments, {name: each for name, each in named.items() if name != "env_params"}


@contextmanager
def _naming_what_is_no_array(method: Callable[..., Any], arguments: Any) -> Iterator[None]:
    try:
        yield
    except TypeError:
        refuse_what_is_no_array(method.__name__, arguments)
        raise
