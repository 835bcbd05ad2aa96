"""kinetix-env's scheme: projected Gauss–Seidel with Baumgarte stabilisation, its quirks included.

One velocity kick, ten sweeps, one drift. Contacts of a kind are solved in batches: all points of a
batch see the same velocities (Jacobi), the batches follow each other (Gauss–Seidel). Levels and
agents were made with this engine, so the preset `jax2d` has to reproduce it; docs/physics.md lists
where it fails. Worlds are on the last axis.
"""

from kinetix.engine.solvers.pgs_baumgarte.solver import PgsBaumgarte

__all__ = ["PgsBaumgarte"]
