"""Named scenes with known answers: benchmark, tests and File ▸ Examples use the same ones. No JAX.

Names are imported on first use.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from kinetix.scenes.catalogue import SCENES, scenes_named
    from kinetix.scenes.model import SCENE_CLASSES, SuiteScene, Trial

_HOME = {
    "SCENES": "catalogue",
    "SCENE_CLASSES": "model",
    "SuiteScene": "model",
    "Trial": "model",
    "scenes_named": "catalogue",
}

__all__ = ["SCENES", "SCENE_CLASSES", "SuiteScene", "Trial", "scenes_named"]


def __getattr__(name: str) -> Any:
    """Import a public name on first use."""
    if name not in _HOME:
        raise AttributeError(f"module 'kinetix.scenes' has no attribute {name!r}")
    return getattr(importlib.import_module(f"kinetix.scenes.{_HOME[name]}"), name)
