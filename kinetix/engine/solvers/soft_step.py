"""Soft Step: substeps of one soft and one relaxing sweep each."""

import dataclasses
from typing import Any, ClassVar

from kinetix.engine.collision import Slots
from kinetix.engine.solvers.base import AbstractSolver
from kinetix.engine.solvers.room import usual_room
from kinetix.engine.solvers.soft import Scheme, empty_cache, soft_step
from kinetix.engine.solvers.soft_rows import Spring
from kinetix.engine.spec import SceneSpec
from kinetix.engine.types import Control, Parameters, State, World

_CONTACT = Spring(hertz=30.0, damping=10.0, share=0.25)
_JOINT = Spring(hertz=60.0, damping=2.0, share=0.25)


@dataclasses.dataclass(frozen=True, kw_only=True)
class SoftStep(AbstractSolver):
    """Substeps instead of sweeps: each corrects the positions that the last one left.

    A substep is as good as many sweeps, since its errors shrink with the square of its length.
    Loads of a thousand times a link's mass still tear chains, long welds sag, a box sinks under a
    hundred times its mass, and an elastic ball loses up to 8 % of its energy a bounce: it leaves
    with the speed of the start of the step, not with that of the impact. The settings are the
    published ones.

    Source: Catto (2024), "Solver2D", the method "TGS soft" of Box2D 3.
    """

    name: ClassVar[str] = "soft_step"
    substeps: int = 4
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
            substeps=self.substeps,
            sweeps=1,
            relax=1,
            bounce=1,
            contact=self.contact,
            joint=self.joint,
            split=False,
            threshold=self.threshold,
        )
        return soft_step(world, state, control, parameters, spec, scheme, self.slots_for(spec))
