"""Named scenes with known answers: benchmark, tests and File ▸ Examples use the same ones. No JAX.

Names are imported on first use.
"""

from typing import TYPE_CHECKING

from kinetix.lazy import lazy_names

if TYPE_CHECKING:
    from kinetix.scenes.catalogue import SCENES, scenes_named
    from kinetix.scenes.model import SCENE_CLASSES, SuiteScene, Trial

_HOME = {
    "SCENES": "kinetix.scenes.catalogue",
    "SCENE_CLASSES": "kinetix.scenes.model",
    "SuiteScene": "kinetix.scenes.model",
    "Trial": "kinetix.scenes.model",
    "scenes_named": "kinetix.scenes.catalogue",
}

__all__ = ["SCENES", "SCENE_CLASSES", "SuiteScene", "Trial", "scenes_named"]

__getattr__, __dir__ = lazy_names(__name__, _HOME, kinetix_env=False)
