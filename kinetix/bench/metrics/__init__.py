"""Metrics of the scenes: what is measured, and the bounds of good and of failure.

Names are imported on first use.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from kinetix.bench.metrics.base import Judge, Metric
    from kinetix.bench.metrics.judges import JUDGES

_HOME = {"JUDGES": "judges", "Judge": "base", "Metric": "base"}

__all__ = ["JUDGES", "Judge", "Metric"]


def __getattr__(name: str) -> Any:
    """Import a public name on first use."""
    if name not in _HOME:
        raise AttributeError(f"module 'kinetix.bench.metrics' has no attribute {name!r}")
    return getattr(importlib.import_module(f"kinetix.bench.metrics.{_HOME[name]}"), name)
