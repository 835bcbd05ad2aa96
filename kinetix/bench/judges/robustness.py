"""Judges of the scenes about what must not break an engine."""

from collections.abc import Sequence

import numpy as np

from kinetix.bench.judges.base import Judge, Metric, rms
from kinetix.bench.judges.contacts import CONTACT_JUDGES
from kinetix.bench.judges.impacts import IMPACT_JUDGES
from kinetix.bench.judges.joints import JOINT_JUDGES
from kinetix.bench.motion import Motion


def _far_origin(motions: Sequence[Motion]) -> list[Metric]:
    found = []
    for name, unit in (("D2", "rad"), ("S1", "m")):
        home, *away = [motion for motion in motions if motion.trial.name == name]
        for motion in away:
            offset = motion.trial.values["offset"]
            if name == "D2":
                difference = motion.rotation[:, 1] - home.rotation[:, 1]
            else:
                difference = motion.position - (offset, 0.0) - home.position
            broken = motion.wild_after is not None or home.wild_after is not None
            found.append(
                Metric(
                    name="difference",
                    unit=unit,
                    value=None if broken else rms(difference),
                    good=1e-3,
                    fail=0.1,
                    variant=f"{name} at {offset:g} m",
                )
            )
    return found


def _dt_map(motions: Sequence[Motion]) -> list[Metric]:
    judges = IMPACT_JUDGES | JOINT_JUDGES | CONTACT_JUDGES
    cells = []
    for motion in motions:
        metrics = judges[motion.trial.name.split()[0]]([motion])
        passes = all(metric.verdict != "fail" for metric in metrics)
        cells.append(
            Metric(name="passes", unit="1", value=float(passes), variant=motion.trial.name)
        )
    share = float(np.mean([cell.value for cell in cells]))
    return [Metric(name="share that passes", unit="1", value=share, good=1.0, fail=0.75), *cells]


def _degenerate(motions: Sequence[Motion]) -> list[Metric]:
    return [
        Metric(
            name="not finite",
            unit="1",
            value=float(
                not all(
                    np.isfinite(values).all()
                    for values in (
                        motion.position,
                        motion.rotation,
                        motion.velocity,
                        motion.angular_velocity,
                    )
                )
            ),
            good=0.0,
            fail=0.0,
            variant=motion.trial.name,
        )
        for motion in motions
    ]


ROBUSTNESS_JUDGES: dict[str, Judge] = {"R1": _far_origin, "R2": _dt_map, "R3": _degenerate}
"""By the scene's id; those that take more than one run are in `kinetix.bench.probes`."""
