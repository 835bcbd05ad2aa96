"""Tolerances of the engine's own solvers: meaning, unit, what breaks.

The settings of a solver live on the solver.
"""

SLOP = 5e-4
"""Overlap left alone [m]. Larger: visible sinking; zero: contacts open and close in turn."""

SPECULATIVE_DISTANCE = 0.02
"""Contacts are prepared at least this far ahead of touching [m]. Smaller: late contacts for bodies
that speed up within the step; larger: more points to solve, ghost contacts at corners."""

ACCELERATION_MARGIN = 0.01
"""Added to the distance covered at the current speed, for the step's own accelerations [m]."""

TOUCH_SLOP = 5e-3
"""Two bodies that push each other count as touching up to this separation [m]."""

LINEAR_SLOP = 5e-4
"""By how much a feature must beat another before a contact changes over [m]: steady choices."""

GRAZE = 4e-3
"""Overlap up to which a moving body only grazes a face that it does not move along [m]. Smaller:
bodies trip over seams of flush neighbours; larger: they slip past corners that they should hit."""

GRAZE_SPEED = 1e-3
"""By how much more slowly bodies must close along the other face then [m/s]: rounding at rest."""

SAME_LINE = 1e-5
"""Distance at which a corner that leaves a face passes the face's end [m]: less is rounding, and
has no direction. Larger: corners slip past each other that should meet."""

SKIM = 0.25
"""Angle between motion and surface up to which two bodies that touch move along each other, half of
what they may go round a corner in a step [rad]. Zero: what rolls over a corner is slowed down;
larger: a blow gets the direction of a moment at which the bodies have parted."""

LEAST_TURN = 5e-4
"""Faces that turn by less in half a step keep their normals [rad]. Zero: what lies without friction
creeps off as rounding turns it; larger: slow planks give energy to what rolls on them."""

PUSH_SPEED = 3.0
"""Overlaps are resolved no faster than this [m/s]. Larger: bodies pop out of each other."""

LEAST_BOUNCE = 1e-3
"""Slower contacts do not bounce [m/s]. Zero: rounding errors count as blows and blur real ones."""

CLOSED_DISTANCE = 1e-4
"""A contact counts as closed below this separation [m]; only closed ones act when relaxing."""

TAUT = 0.5
"""(Substep · swing rate)² of a body at which its joint counts as taut; a fifth of it as loose.
Larger: light chains gain energy as they swing; smaller: long pendulums lose it."""

CALM_TURN = 0.6
"""Turn in a substep up to which a joint foresees how its arms bend the path [rad]; at twice this it
foresees only as much as its force turned in the last step. Larger: wedged machines are torn;
smaller: joints open that turn fast."""

SETTLED = 0.3
"""Tension of a joint whose gaps are taken out of the positions alone; less so where it is looser.
Larger: joints under tension open as they turn; smaller: what swings loses energy."""

JOINT_SLIP = 5e-4
"""Gap [m] or angle [rad] of a joint up to which velocities may mend it; the rest is taken out of
the positions at once. Larger: loops open as they pass a dead point; smaller: what swings loses
energy."""

MOST_MENDING_TURN = 0.5
"""Turn by which positions are mended at once [rad]. Larger: chains that snap tight are torn, as
their links overshoot; smaller: what is open closes later."""

MOST_LATE = 2
"""Substeps for which a force that has grown counts as unknown, at most. Fewer: light chains that
snap tight are torn; more: they gain energy under many small substeps."""

JOINT_REGULARISATION = 1e-6
"""Relative compliance of the joint rows: keeps redundant loops solvable in float32."""

LEAST_PIVOT = 1e-5
"""Share of a row's own mobility below which what the other joints leave of it counts as nothing.
Smaller: rounding errors of bodies that joints hold altogether become huge impulses; larger: light
links between heavy bodies stop answering."""

DEEP = 2e-3
"""Overlaps of bodies that joints hold yield a little beyond this [m]."""

HELD = 0.9
"""Joints hold a contact's bodies when they leave less than this share of their mobility."""

DEEP_COMPLIANCE = 0.01
"""Speed that such a contact lets through per impulse, as a share of what the impulse would give
free bodies. Zero: wedged bodies get impulses without bound; larger: heavy loads sink deeper."""

USUAL_CONTRAST = 3.0
"""Ratio of the loads of two touching bodies up to which they count as alike."""

USUAL_BURDEN = 12.0
"""Times its own weight up to which what a body bears asks for no more sweeps."""

WEIGHT_OF_BURDEN = 4.0
"""Factor of a burden when it is added to the ratios of unlike loads. Smaller: towers that become
heavier and heavier upwards begin to rock; larger: jammed machines are slow."""

MOST_BORNE = 30.0
"""Times its own mass that a body may bear before it counts as heavier than it is. Smaller: what
stands on light bodies moves more sluggishly; larger: heavy balls burst bridges of light planks."""
