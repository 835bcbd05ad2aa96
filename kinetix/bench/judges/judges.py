"""All judges by the scene's id."""

from typing import Final

from kinetix.bench.judges.base import Judge
from kinetix.bench.judges.built import BUILT_JUDGES
from kinetix.bench.judges.contacts import CONTACT_JUDGES
from kinetix.bench.judges.friction import FRICTION_JUDGES
from kinetix.bench.judges.impacts import IMPACT_JUDGES
from kinetix.bench.judges.integrator import INTEGRATOR_JUDGES
from kinetix.bench.judges.joints import JOINT_JUDGES
from kinetix.bench.judges.robustness import ROBUSTNESS_JUDGES

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
