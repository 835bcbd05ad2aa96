"""Scenes about what must not break an engine: places, time steps, degenerate and random levels."""

import math

from kinetix.level.builder import rectangle
from kinetix.level.codec import load_level
from kinetix.level.model import Circle, Level, Motor, Polygon
from kinetix.paths import levels_dir
from kinetix.scenes.contacts import heavy_on_light, stack
from kinetix.scenes.impacts import bouncing_disc
from kinetix.scenes.joints import hanging_chain, pendulum
from kinetix.scenes.model import STEP, SuiteScene, Trial
from kinetix.scenes.stage import Stage

RATES = (30, 60, 120, 240)
"""Steps per second of the map over time steps."""


def _far_origin() -> tuple[Trial, ...]:
    return tuple(
        make(offset)
        for make in (
            lambda offset: pendulum(45, name="D2", offset=offset),
            lambda offset: stack(5, name="S1", offset=offset),
        )
        for offset in (0.0, 10.0, 1000.0)
    )


def _dt_map() -> tuple[Trial, ...]:
    return tuple(
        trial
        for rate in RATES
        for trial in (
            bouncing_disc(1.0, 10.0, dt=1 / rate, name=f"B1 {rate} Hz"),
            pendulum(45, dt=1 / rate, name=f"D2 {rate} Hz"),
            hanging_chain(100, dt=1 / rate, name=f"D5 {rate} Hz"),
            stack(10, dt=1 / rate, name=f"S1 {rate} Hz"),
            heavy_on_light(100, dt=1 / rate, name=f"S3 {rate} Hz"),
        )
    )


def _degenerate() -> tuple[Trial, ...]:
    def trial(name: str, level: Level, action: float = 1.0, inactive: bool = False) -> Trial:
        return Trial(
            level=level,
            duration=2.0,
            name=name,
            motor=action,
            thruster=action,
            inactive=inactive,
        )

    stages = {
        name: Stage(name.capitalize(), floor=True)
        for name in (
            "zero radius",
            "zero area",
            "coincident centres",
            "identical polygons",
            "joint to itself",
            "joint between fixed bodies",
            "everything inactive",
            "action not a number",
        )
    }
    stages["zero radius"].body(Circle(radius=0.0), 0.0, 0.1)
    stages["zero area"].body(Polygon(vertices=((0.0, 0.0),) * 3), 0.0, 0.1)
    stages["zero area"].body(Polygon(vertices=((-0.1, 0.0), (0.1, 0.0), (0.0, 0.0))), 1.0, 0.1)
    for _ in range(2):
        stages["coincident centres"].disc(0.1, 0.0, 0.5)
        stages["identical polygons"].body(Polygon(vertices=rectangle(0.2, 0.2)), 0.0, 0.5)
    own = stages["joint to itself"]
    own.join("revolute", own.post(0.1, 0.5), own.box(0.2, 0.2, 0.0, 0.5), (0.1, 0.5), motor=Motor())
    fixed = stages["joint between fixed bodies"]
    posts = fixed.box(0.2, 0.2, 0.0, 0.5, fixed=True), fixed.box(0.2, 0.2, 0.1, 0.5, fixed=True)
    fixed.join("revolute", *posts, (0.05, 0.5), motor=Motor())
    fixed.join("fixed", *posts, (0.05, 0.5))
    stages["everything inactive"].box(0.2, 0.2, 0.0, 0.5)
    odd = stages["action not a number"]
    disc = odd.disc(0.2, 0.0, 0.6)
    odd.join("revolute", odd.post(0.0, 0.6), disc, (0.0, 0.6), motor=Motor())
    odd.thruster(odd.box(0.2, 0.2, 1.0, 0.5), (1.0, 0.5), 0.0, 1.0)
    return tuple(
        trial(
            name,
            _joined_to_itself(stage.level()) if name == "joint to itself" else stage.level(),
            action=math.nan if name == "action not a number" else 1.0,
            inactive=name == "everything inactive",
        )
        for name, stage in stages.items()
    )


def _joined_to_itself(level: Level) -> Level:
    """Let the only joint hold its second body at both ends, which no builder allows."""
    (joint,) = level.joints
    return level.replace(
        bodies=tuple(body for body in level.bodies if body.id == joint.b),
        joints=(joint.replace(a=joint.b, anchor_a=joint.anchor_b),),
    )


def _bundled() -> tuple[Level, ...]:
    files = sorted(levels_dir().glob("[sml]/*.json"))
    return tuple(load_level(file) for file in files)


def _reordered(level: Level) -> Level:
    return level.replace(bodies=tuple(reversed(level.bodies)))


def _determinism() -> tuple[Trial, ...]:
    chosen = _bundled()[:5]
    return tuple(
        Trial(level=level, duration=256 * STEP, name=name, phase=index, motor=1.0, thruster=1.0)
        for name, change in (("as it is", lambda level: level), ("bodies reversed", _reordered))
        for index, level in enumerate(map(change, chosen))
    )


def _levels() -> tuple[Trial, ...]:
    return tuple(
        Trial(level=level, duration=1.0, name=level.name, motor=1.0, thruster=1.0)
        for level in _bundled()
    )


ROBUSTNESS = (
    SuiteScene(
        id="R1",
        name="far origin",
        group="robustness",
        core=True,
        make_trials=_far_origin,
        note="Pendulum and stack 10 and 1000 m away move as they do at home.",
    ),
    SuiteScene(
        id="R2",
        name="time steps",
        group="robustness",
        core=True,
        make_trials=_dt_map,
        note="Five scenes at four time steps: in how many cells nothing fails.",
    ),
    SuiteScene(
        id="R3",
        name="degenerate",
        group="robustness",
        core=True,
        make_trials=_degenerate,
        note="Bodies without size, joints without sense, actions that are not numbers.",
    ),
    SuiteScene(
        id="R4",
        name="determinism",
        group="robustness",
        core=False,
        make_trials=_determinism,
        note="The same bits twice; alone as in a batch; whatever the order of bodies.",
    ),
    SuiteScene(
        id="R5",
        name="wild",
        group="robustness",
        core=True,
        make_trials=tuple,
        note="4096 random levels under random actions: drawn at run time, no document to open.",
    ),
    SuiteScene(
        id="R6",
        name="levels",
        group="robustness",
        core=False,
        make_trials=_levels,
        note="Hand-made levels under a fixed action, against a run with a sixteenth of the step.",
    ),
)
"""In the order of their ids."""
