"""The solvers of this kind: one method with three settings."""

from typing import Final

from kinetix.engine.solvers.soft.solver import Soft
from kinetix.engine.solvers.soft.springs import Spring

SOFT: Final = {
    # One kick, soft sweeps, one drift, relaxing sweeps. What Gauss–Seidel cannot do: heavy loads on
    # light bodies, long chains and welds; and a single explicit step is of first order.
    "pgs_soft": Soft(
        sweeps=8,
        relax=4,
        contact=Spring(hertz=30.0, damping=10.0, share=0.5),
        joint=Spring(hertz=60.0, damping=2.0, share=0.5),
    ),
    # The method "TGS soft" of Box2D 3 with its published settings. A substep is as good as many
    # sweeps, since its errors shrink with the square of its length. Loads of a thousand times a
    # link's mass still tear chains, long welds sag, a box sinks under a hundred times its mass, and
    # an elastic ball loses up to 8 % of its energy per bounce: it leaves with the speed of the
    # start of the step, not with that of the impact.
    "soft_step": Soft(
        substeps=4,
        contact=Spring(hertz=30.0, damping=10.0, share=0.25),
        joint=Spring(hertz=60.0, damping=2.0, share=0.25),
    ),
    # A body with k contacts and joints is split into k bodies of a k-th of its mass; every contact
    # is solved on its own copies, then the copies are averaged. That converges where plain Jacobi
    # overshoots, and is wide instead of deep; but it takes four to five times the iterations of
    # Gauss–Seidel, so stacks, chains and welds are soft. Source: Tonge, Benevolenski & Voroshilov
    # (2012), "Mass Splitting for Jitter-Free Parallel Rigid Body Simulation".
    "jacobi": Soft(
        sweeps=24,
        relax=12,
        bounce=4,
        split=True,
        contact=Spring(hertz=30.0, damping=10.0, share=0.5),
        joint=Spring(hertz=60.0, damping=2.0, share=0.5),
    ),
}
"""The settings by name."""
