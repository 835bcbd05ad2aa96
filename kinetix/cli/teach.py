"""Make a data set of winning plans for random levels; the same --out goes on where it stopped."""

import contextlib
import dataclasses
from typing import TYPE_CHECKING, Annotated

import tyro

from kinetix.cli.shared.terminal import Terminal
from kinetix.command_line.paths import NamedPath
from kinetix.engine.names import DEFAULT_PHYSICS
from kinetix.errors import KinetixError
from kinetix.failures import Terminated, terminable
from kinetix.wording import plural, thousands

if TYPE_CHECKING:
    from kinetix.training.imitation.teach import Yield


@dataclasses.dataclass(frozen=True, kw_only=True)
class Teach:
    """Search random levels for wins and keep them, for `kinetix train bc`."""

    size: str
    """s, m, l, locomotion, or polygons with the arena, circles, joints, thrusters: 12,4,6,2."""
    count: int
    """Number of levels to be won, those that are there included. 256 are searched at a time, so
    more may be won."""
    out: Annotated[NamedPath, tyro.conf.arg(metavar="DIR")]
    """Folder of the data set."""
    seed: int = 0
    """Equal seeds give equal levels."""
    physics: str = DEFAULT_PHYSICS
    """Physics preset or solver."""
    rounds: int = 2
    """Rounds of search after which a level is given up."""
    batch: int = 32
    """Levels that are searched at once: a divisor of 256."""
    copies: int = 2
    """Perturbed starts per level that are tried too, each with a round of its own."""
    no_mirror: bool = False
    """Leave out mirror images; otherwise each is tried with the plan of its level."""
    machines: bool = False
    """Random machines (cars, arms, rockets, …) instead of heaps of random shapes."""
    cores: int | None = None
    """Processor cores to use (KINETIX_CORES, else all)."""


def run(command: Teach) -> int:
    """Search until enough levels are won; 0 when they are."""
    # Imported here, so that a wrong command line fails before JAX loads.
    from kinetix.training.imitation.teach import SHARD, TeachConfig, teach

    if command.count < 1:
        raise KinetixError(f"--count {command.count}: expected at least 1")
    config = TeachConfig(
        size=command.size,
        seed=command.seed,
        physics=command.physics,
        rounds=command.rounds,
        batch=command.batch,
        copies=command.copies,
        mirror=not command.no_mirror,
        machines=command.machines,
    )

    with terminable(), contextlib.closing(Terminal()) as terminal:
        written = 0

        def report(so_far: "Yield") -> None:
            nonlocal written
            written = so_far.episodes
            if so_far.won < command.count:  # the last one is the result
                terminal.say(_told(so_far))

        try:
            done = teach(config, command.count, command.out, report=report, status=terminal.status)
        except (KeyboardInterrupt, Terminated):
            kept = f"{plural(written, 'episode')} of this search kept; " if written else ""
            terminal.say(
                f"stopped: {kept}the same command goes on with the {SHARD} levels under way"
            )
            raise
    print(f"{command.out}: {_told(done)}")
    return 0


def _told(so_far: "Yield") -> str:
    return (
        f"{so_far.won} of {so_far.levels} levels won ({so_far.share:.0%} of those that doing "
        f"nothing does not win), {so_far.episodes} episodes, {thousands(so_far.steps)} steps, "
        f"{so_far.seconds_per_win:.2f} s a win"
    )
