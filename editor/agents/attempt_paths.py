"""The ways of all attempts of an agent on a level, and which of them are drawn."""

import dataclasses

from editor.agents.evaluation import Plan
from editor.worker.requests import AttemptPaths


@dataclasses.dataclass(kw_only=True)
class Ways:
    """The paths of one agent's attempts on one level of an evaluation."""

    plan: Plan
    level: int
    """Index into the plan's levels."""
    agent: int
    """Index into the plan's agents."""
    paths: AttemptPaths
    outcomes: tuple[str, ...] = ()
    """Only ways that end so are drawn; empty: all."""
    ending: int | None = None
    """Only ways of this group of `paths.endings` are drawn; None: of all."""
    lit: int | None = None
    """The attempt that is pointed at."""

    def parting(self, attempt: int) -> int | None:
        """Return the step at which an attempt leaves the wins; None where it does not."""
        paths = self.paths
        own = next((one for one in paths.endings if attempt in one.attempts), None)
        return paths.parting if own is None or own.parting is None else own.parting
