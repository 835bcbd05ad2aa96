"""Metrics of the scenes: what is measured, and the bounds of good and of failure.

Names are imported on first use.
"""

from typing import TYPE_CHECKING

from kinetix.lazy import lazy_names

if TYPE_CHECKING:
    from kinetix.bench.judges.base import Judge, Metric
    from kinetix.bench.judges.judges import JUDGES

_HOME = {
    "JUDGES": "kinetix.bench.judges.judges",
    "Judge": "kinetix.bench.judges.base",
    "Metric": "kinetix.bench.judges.base",
}

__all__ = ["JUDGES", "Judge", "Metric"]

__getattr__, __dir__ = lazy_names(__name__, _HOME, kinetix_env=False)
