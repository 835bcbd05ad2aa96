"""All scenes of the accuracy suite by id."""

from typing import Final

from kinetix.errors import KinetixError
from kinetix.scenes.contacts import CONTACTS
from kinetix.scenes.friction import FRICTION
from kinetix.scenes.impacts import IMPACTS
from kinetix.scenes.integrator import INTEGRATOR
from kinetix.scenes.joints import JOINTS
from kinetix.scenes.model import SuiteScene
from kinetix.scenes.robustness import ROBUSTNESS

SCENES: Final[dict[str, SuiteScene]] = {
    scene.id: scene
    for group in (INTEGRATOR, IMPACTS, FRICTION, JOINTS, CONTACTS, ROBUSTNESS)
    for scene in group
}
"""In the order of classes and ids."""


def scenes_named(text: str) -> tuple[SuiteScene, ...]:
    """The scenes that a command line means: `core`, `all`, or ids with commas between them.

    Raises:
        KinetixError: An id is unknown.
    """
    if text == "all":
        return tuple(SCENES.values())
    if text == "core":
        return tuple(scene for scene in SCENES.values() if scene.core)
    ids = [part.strip() for part in text.split(",")]
    unknown = [each for each in ids if each not in SCENES]
    if unknown:
        raise KinetixError(
            f"--scenes {text}: there is no scene {unknown[0]!r}; "
            f"expected core, all, or some of {','.join(SCENES)}"
        )
    return tuple(SCENES[each] for each in ids)
