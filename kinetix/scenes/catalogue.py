"""All scenes of the accuracy suite by id."""

from typing import Final

from kinetix.errors import KinetixError
from kinetix.scenes.built.fast import FAST
from kinetix.scenes.built.loads import LOADS
from kinetix.scenes.built.stacks import STACKS
from kinetix.scenes.built.surfaces import SURFACES
from kinetix.scenes.contacts import CONTACTS
from kinetix.scenes.friction import FRICTION
from kinetix.scenes.impacts import IMPACTS
from kinetix.scenes.integrator import INTEGRATOR
from kinetix.scenes.joints import JOINTS
from kinetix.scenes.model import SCENE_CLASSES, SuiteScene
from kinetix.scenes.robustness import ROBUSTNESS

SCENES: Final[dict[str, SuiteScene]] = {
    scene.id: scene
    for group in (
        INTEGRATOR,
        IMPACTS,
        FRICTION,
        JOINTS,
        CONTACTS,
        ROBUSTNESS,
        STACKS,
        SURFACES,
        FAST,
        LOADS,
    )
    for scene in group
}
"""In the order of classes and ids."""


def scenes_named(text: str) -> tuple[SuiteScene, ...]:
    """Return the scenes that a command line means: `core`, `all`, classes and ids with commas.

    Raises:
        KinetixError: An id is unknown.
    """
    groups: dict[str, list[str]] = {
        "all": list(SCENES),
        "core": [scene.id for scene in SCENES.values() if scene.core],
        **{
            name: [each.id for each in SCENES.values() if each.group == name]
            for name in SCENE_CLASSES
        },
    }
    parts = [part.strip() for part in text.split(",")]
    unknown = [part for part in parts if part not in groups and part not in SCENES]
    if unknown:
        raise KinetixError(
            f"--scenes {text}: there is no scene {unknown[0]!r}; "
            f"expected {', '.join(groups)}, or some of {','.join(SCENES)}"
        )
    named = [id for part in parts for id in groups.get(part, [part])]
    return tuple(SCENES[id] for id in dict.fromkeys(named))
