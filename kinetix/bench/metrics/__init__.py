"""Metrics of the scenes: what is measured, and the bounds of good and of failure.

Names are imported on first use.
"""

from typing import TYPE_CHECKING

from kinetix.lazy import lazy_names

if TYPE_CHECKING:
    from kinetix.bench.metrics.base import Judge, Metric
    from kinetix.bench.metrics.judges import JUDGES

_HOME = {
    "JUDGES": "kinetix.bench.metrics.judges",
    "Judge": "kinetix.bench.metrics.base",
    "Metric": "kinetix.bench.metrics.base",
}

__all__ = ["JUDGES", "Judge", "Metric"]

__getattr__, __dir__ = lazy_names(__name__, _HOME, kinetix_env=False)
