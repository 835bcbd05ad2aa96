"""Jacobi iterations on split bodies: everything at once, nothing in turn."""

import dataclasses
from typing import Any, ClassVar

from kinetix.engine.collision import Slots
from kinetix.engine.solvers.base import AbstractSolver
from kinetix.engine.solvers.room import usual_room
from kinetix.engine.solvers.soft import Scheme, empty_cache, soft_step
from kinetix.engine.solvers.soft_rows import Spring
from kinetix.engine.spec import SceneSpec
from kinetix.engine.types import Control, Parameters, State, World

_CONTACT = Spring(hertz=30.0, damping=10.0, share=0.5)
_JOINT = Spring(hertz=60.0, damping=2.0, share=0.5)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Jacobi(AbstractSolver):
    """Contacts and joints solved at once, each on its own share of its bodies' masses.

    A body with k contacts and joints is split into k bodies of a k-th of its mass; every contact is
    solved on its own copies, then the copies are averaged. That converges where plain Jacobi
    overshoots, and is wide instead of deep; but it takes four to five times the iterations of
    Gauss–Seidel, so stacks, chains and welds are soft.

    Source: Tonge, Benevolenski & Voroshilov (2012), "Mass Splitting for Jitter-Free Parallel Rigid
    Body Simulation"; positions are corrected softly as in `pgs_soft`.
    """

    name: ClassVar[str] = "jacobi"
    iterations: int = 24
    """Soft iterations."""
    relax: int = 12
    """Iterations without position correction after the drift."""
    bounce: int = 4
    """Iterations over the bouncing contacts."""
    contact: Spring = _CONTACT
    joint: Spring = _JOINT
    threshold: float = 1.0
    """Contacts that close slower than this do not bounce [m/s]."""
    slots: Slots | None = None
    """Room for contacts; None: by the capacity."""

    def slots_for(self, spec: SceneSpec) -> Slots:
        """Room for contacts in scenes of this capacity."""
        return self.slots or usual_room(spec)

    def empty_cache(self, spec: SceneSpec) -> Any:
        """No impulses."""
        return empty_cache(spec, self.slots_for(spec))

    def step(
        self, world: World, state: State, control: Control, parameters: Parameters, spec: SceneSpec
    ) -> State:
        """See the contract."""
        scheme = Scheme(
            substeps=1,
            sweeps=self.iterations,
            relax=self.relax,
            bounce=self.bounce,
            contact=self.contact,
            joint=self.joint,
            split=True,
            threshold=self.threshold,
        )
        return soft_step(world, state, control, parameters, spec, scheme, self.slots_for(spec))
