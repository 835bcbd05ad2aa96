"""Episodes of commands: an attempt of an evaluation, or draws of their own."""

import functools
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, Final, Protocol

from kinetix.errors import KinetixError

if TYPE_CHECKING:
    from kinetix.agents.evaluate import RecordedStep
    from kinetix.agents.player import Player

_MOST: Final = 2**31 - 1


class Asked(Protocol):
    """The options of a command that shows an episode."""

    @property
    def level(self) -> str:
        """A file, or the name of a bundled level."""
        ...

    @property
    def seed(self) -> int:
        """Seed of the agent's draws."""
        ...

    @property
    def physics(self) -> str | None:
        """Physics preset or solver; None: the agent's own."""
        ...

    @property
    def deterministic(self) -> bool:
        """True if the likeliest action is taken."""
        ...


def check_attempt(attempt: int | None, players: Sequence[str]) -> None:
    """Refuse an attempt that no evaluation has.

    Args:
        attempt: From the command line; None where an episode of its own is meant.
        players: Values of `--agent` and `--rival`.

    Raises:
        KinetixError: The attempt is out of range, or only recorded solutions play.
    """
    if attempt is None:
        return
    if not 0 <= attempt <= _MOST:
        raise KinetixError(f"--attempt {attempt}: expected a number from 0 to {_MOST}")
    from kinetix.agents.named import SOLUTION  # which loads JAX

    if all(player == SOLUTION for player in players):
        raise KinetixError(
            f"--attempt {attempt}: a recorded solution is a single episode; leave --attempt "
            "out, or name an agent"
        )


def steps_of_attempt(command: Asked, player: "Player", attempt: int) -> "Iterator[RecordedStep]":
    """Play an attempt of an evaluation, the same to the bit.

    Args:
        command: Level, seed, physics and mode of the evaluation.
        player: Who plays.
        attempt: Its number.
    """
    from kinetix.agents.evaluate import NamedLevel, Settings, record

    settings = Settings(
        seed=command.seed, physics=command.physics or "", deterministic=command.deterministic
    )
    return record(player, NamedLevel(name=command.level, source=command.level), attempt, settings)


def decide_of(command: Asked, player: "Player") -> Callable[..., Any]:
    """Return how the player chooses actions in an episode with draws of its own.

    Args:
        command: The command, for its mode.
        player: Who plays.
    """
    decide = player.policy.decide
    return functools.partial(decide, deterministic=True) if command.deterministic else decide
