"""Sequential impulses with soft constraints and a relaxing pass."""

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
class PgsSoft(AbstractSolver):
    """Projected Gauss–Seidel: one kick, soft sweeps, one drift, relaxing sweeps.

    Soft constraints take their share of a position error away without the energy that Baumgarte's
    bias leaves behind. What remains is what Gauss–Seidel cannot do: heavy loads on light bodies,
    long chains and welds; and the first order of a single explicit step.

    Source: Catto (2011), "Soft Constraints"; the relaxing pass after Catto (2024), "Solver2D".
    """

    name: ClassVar[str] = "pgs_soft"
    iterations: int = 8
    """Soft sweeps over all joints and contacts."""
    relax: int = 4
    """Sweeps without position correction after the drift."""
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
            bounce=1,
            contact=self.contact,
            joint=self.joint,
            split=False,
            threshold=self.threshold,
        )
        return soft_step(world, state, control, parameters, spec, scheme, self.slots_for(spec))
