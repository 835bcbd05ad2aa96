"""Demonstrations: recorded wins as first states and actions, in slots of one size."""

import dataclasses
import hashlib
from collections.abc import Callable, Sequence
from typing import Any

import jax
import numpy as np
from jaxtyping import Int

from kinetix.datasets.episode import Origin
from kinetix.datasets.sources import episodes_of, origins_of, untold
from kinetix.engine.spec import Capacity
from kinetix.environment.params import StaticEnvParams
from kinetix.environment.reset import level_state
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError


@dataclasses.dataclass(frozen=True, kw_only=True)
class Demonstration:
    """A win to learn from."""

    state: EnvState
    """First state, as numpy arrays."""
    actions: Int[np.ndarray, "k 6"]
    """Multi-discrete, one per environment step, up to the winning one."""
    level: str = ""
    """Name of the level, which its copies and mirror images share."""


def origin_of(sources: Sequence[str]) -> Origin:
    """Return the smallest origin that all demonstrations fit: the largest of each capacity.

    Args:
        sources: As for `kinetix.datasets.sources.episodes_of`.

    Raises:
        KinetixError: There is nothing to learn from, or the parts do not belong together.
    """
    origins = list(dict.fromkeys(origin for source in sources for origin in origins_of(source)))
    if not origins:
        raise KinetixError(
            f"{', '.join(sources)}: no win to learn from; expected data of `kinetix teach` or "
            "`kinetix dataset`, won episodes that the editor saved, or levels with a recorded "
            "solution"
        )
    for name in ("physics", "frame_skip"):
        found = sorted({str(getattr(origin, name)) for origin in origins})
        if len(found) > 1:
            raise KinetixError(
                f"{', '.join(sources)}: expected one {name} in all demonstrations, got "
                f"{' and '.join(found)}"
            )
    sizes = [dataclasses.asdict(origin.capacity) for origin in origins]
    widest = Capacity(**{name: max(size[name] for size in sizes) for name in sizes[0]})
    return dataclasses.replace(origins[0], capacity=widest)


def demonstrations(
    sources: Sequence[str],
    static_env_params: StaticEnvParams,
    tell: Callable[[str], Any] = untold,
) -> list[Demonstration]:
    """Return all wins, in slots of one size.

    Args:
        sources: As for `kinetix.datasets.sources.episodes_of`.
        static_env_params: Of the environment in which they are to be played.
        tell: As for `kinetix.datasets.sources.episodes_of`.

    Raises:
        KinetixError: A source is missing or damaged, or a level does not fit.
    """
    return [
        Demonstration(
            state=jax.tree.map(np.asarray, level_state(found.episode.level, static_env_params)),
            actions=found.episode.action,
            level=found.episode.level.name,
        )
        for source in sources
        for found in episodes_of(source, tell)
        if found.episode.outcome == "won"
    ]


def digest_of(episodes: Sequence[Demonstration]) -> str:
    """Return the SHA-256 of demonstrations, in their order.

    Args:
        episodes: The demonstrations.
    """
    found = hashlib.sha256()
    for each in episodes:
        for leaf in jax.tree.leaves((each.state, each.actions)):
            found.update(leaf.tobytes())
    return found.hexdigest()
