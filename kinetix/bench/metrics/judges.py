"""All judges by the scene's id."""

from typing import Final

from kinetix.bench.metrics.base import Judge
from kinetix.bench.metrics.built import BUILT_JUDGES
from kinetix.bench.metrics.contacts import CONTACT_JUDGES
from kinetix.bench.metrics.friction import FRICTION_JUDGES
from kinetix.bench.metrics.impacts import IMPACT_JUDGES
from kinetix.bench.metrics.integrator import INTEGRATOR_JUDGES
from kinetix.bench.metrics.joints import JOINT_JUDGES
from kinetix.bench.metrics.robustness import ROBUSTNESS_JUDGES

JUDGES: Final[dict[str, Judge]] = (
    INTEGRATOR_JUDGES
    | IMPACT_JUDGES
    | FRICTION_JUDGES
    | JOINT_JUDGES
    | CONTACT_JUDGES
    | ROBUSTNESS_JUDGES
    | BUILT_JUDGES
)
"""R4, R5 and R6 are measured by `kinetix.bench.probes`."""
