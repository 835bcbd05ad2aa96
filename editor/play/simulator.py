"""The simulation as playback sees it."""

from collections.abc import Sequence
from typing import Protocol

from editor.worker.requests import Casting, Pull
from editor.worker.snapshots import Action, Snapshot
from kinetix.level.model import Level


class Simulator(Protocol):
    """Interface of the simulation to playback; answers may come in later frames."""

    keep_contacts: bool
    """True if the snapshots to come carry contact points (debug drawing, plots)."""

    @property
    def outstanding(self) -> int:
        """Steps that were asked for and have not arrived."""
        ...

    def start(
        self,
        level: Level,
        physics: str,
        casting: Casting | None = None,
        since: Snapshot | None = None,
    ) -> None:
        """Go to a level's first state; its snapshot arrives first.

        With `since` the episode has come so far already: steps and return go on from there.
        """
        ...

    def advance(self, actions: tuple[Action | None, ...], pull: Pull | None = None) -> None:
        """Play one environment step for each action; after the episode's end nothing arrives.

        None in the place of an action leaves the choice to the agent that was cast.
        """
        ...

    def restore(self, snapshot: Snapshot) -> None:
        """Go on from an earlier snapshot of this episode; nothing arrives for it."""
        ...

    def stop(self) -> None:
        """Drop everything that was asked for."""
        ...

    def drop(self) -> None:
        """Drop the steps that were asked for; the episode stays."""
        ...

    def take(self) -> Sequence[Snapshot]:
        """Snapshots that arrived since the last call, in order.

        Raises:
            KinetixError: The simulation failed; the message says why.
        """
        ...
