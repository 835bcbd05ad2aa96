"""Checks of arguments of Gymnasium's methods, and of the calling process."""

import inspect
from collections.abc import Mapping, Sequence
from typing import Any, Final

import gymnasium
import numpy as np

from kinetix.bounds import LAST_SEED
from kinetix.environment.named import make_named_env
from kinetix.errors import KinetixError
from kinetix.forks import refuse_forked_process

PICTURE_SIDES: Final = (50, 4000)
"""Least and greatest side of a picture [px]."""


def refuse_fork() -> None:
    """Refuse to compute in a process that was forked from one in which JAX runs.

    Raises:
        KinetixError: This is one.
    """
    refuse_forked_process(
        'start it again, as gymnasium.make_vec(…, vectorization_mode="async", '
        'vector_kwargs={"context": "spawn"}), AsyncVectorEnv(…, context="spawn") or '
        'SubprocVecEnv(…, start_method="spawn") do; or step a batch in one process, with '
        "gymnasium.make_vec as it is"
    )


def checked_options(options: Any, *known: str) -> Mapping[str, Any]:
    """Return the options of a reset; empty where there are none.

    Args:
        options: What the caller passed.
        *known: The names that mean something.

    Raises:
        KinetixError: `options` is not a dictionary, or has another name.
    """
    if options is None:
        return {}
    if not isinstance(options, Mapping):
        kind = type(options).__name__
        raise KinetixError(
            f"reset options: expected a dictionary with {_listed(known)}, got {kind}"
        )
    for name in options:
        if name not in known:
            raise KinetixError(f"reset option {name!r}: expected {_listed(known)}")
    return options


def checked_words(words: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the keywords of an environment that Gymnasium hands on.

    Raises:
        KinetixError: A keyword is unknown; the message lists those that exist.
    """
    known = [name for name in inspect.signature(make_named_env).parameters if name != "auto_reset"]
    known += ["render_mode", "render_size"]
    for word in words:
        if word not in known:
            raise KinetixError(f"{word}: no keyword of this environment; it has {', '.join(known)}")
    return words


def check_count(name: str, value: Any, *, optional: bool = False) -> None:
    """Refuse what is no number of things, from 1.

    Args:
        name: What the caller knows it as.
        value: What the caller passed.
        optional: Whether None will do.

    Raises:
        KinetixError: `value` is not a whole number from 1.
    """
    if not (_is_whole(value) and value >= 1) and not (optional and value is None):
        or_none = ", or None" if optional else ""
        raise KinetixError(f"{name}={value!r}: expected a whole number from 1{or_none}")


def check_render_mode(mode: Any, known: Sequence[str]) -> None:
    """Refuse a way of showing pictures that there is not.

    Args:
        mode: What the caller passed; None: no pictures.
        known: The ways that there are.

    Raises:
        KinetixError: The mode is unknown.
    """
    if mode is not None and mode not in known:
        raise KinetixError(f"render_mode={mode!r}: expected {', '.join(known)} or None")


def check_render_size(size: Any) -> None:
    """Refuse a size of pictures that cannot be.

    Args:
        size: What the caller passed; None: the usual one.

    Raises:
        KinetixError: The size is not a whole number, too small or too large.
    """
    least, most = PICTURE_SIDES
    if size is not None and not (_is_whole(size) and least <= size <= most):
        raise KinetixError(
            f"render_size={size!r}: expected a whole number of pixels from {least} to {most}, "
            "or None"
        )


def _is_whole(value: Any) -> bool:
    return isinstance(value, int | np.integer) and not isinstance(value, bool)


def checked_seed(seed: Any) -> int:
    """Return a seed as a Python number.

    Raises:
        KinetixError: The seed is not a whole number, or too large.
    """
    if not _is_whole(seed) or not 0 <= seed <= LAST_SEED:
        raise KinetixError(f"seed={seed!r}: expected a whole number from 0 to {LAST_SEED}")
    return int(seed)


def numbers_of(action: Any) -> np.ndarray:
    """Return an action, or a batch, as a numpy array.

    Raises:
        KinetixError: The action holds something other than numbers.
    """
    try:
        array = np.asarray(action)
    except ValueError:  # rows of different lengths
        array = np.asarray(None)
    if array.dtype.kind not in "biuf":
        kind = type(action).__name__
        raise KinetixError(
            f"action: expected numbers as env.action_space.sample() draws, got {kind}"
        )
    if array.dtype.kind == "f" and np.isnan(array).any():
        raise KinetixError("action: holds a NaN; expected numbers")
    return array


def check_fits(action: np.ndarray, space: gymnasium.Space[Any]) -> None:
    """Refuse an action, or a batch, of another shape or type than a space has.

    Args:
        action: From `numbers_of`.
        space: The `action_space` that the caller sees.

    Raises:
        KinetixError: The action has another shape or type than the space; the message says which.
    """
    if action.shape != space.shape:
        raise KinetixError(
            f"action of shape {action.shape}: expected {space.shape}, as "
            "env.action_space.sample() draws"
        )
    if action.dtype.kind == "f" and np.dtype(space.dtype).kind != "f":
        raise KinetixError(
            f"action of type {action.dtype}: expected whole numbers; for reals make the "
            'environment with action_type="continuous"'
        )


def _listed(names: tuple[str, ...]) -> str:
    return " or ".join(map(repr, names))
