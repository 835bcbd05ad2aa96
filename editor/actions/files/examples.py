"""Opens what comes with the app: scenes of the accuracy suite, and levels to begin with."""

import functools
from typing import TYPE_CHECKING, Final

from editor.documents.document import Document
from editor.editing.picking import selection_box
from editor.session import Session
from kinetix.errors import CommandError
from kinetix.level.codec import load_level
from kinetix.paths import levels_dir

if TYPE_CHECKING:
    from kinetix.scenes import SuiteScene

_SMALLEST: Final = 3.0
"""Side of what is shown at least, so that a lone ball is not all that one sees [m]."""


TEMPLATES: Final = {
    "car": ("Car", "l/rover_ridge"),
    "lander": ("Lander", "m/touchdown"),
    "catapult": ("Catapult", "m/trebuchet"),
    "walker": ("Walker", "l/first_steps"),
    "arm": ("Arm", "l/ladle"),
    "crane": ("Crane", "l/skyhook"),
}
"""Label and bundled level of what a new level can begin with, by id."""


def new_from(session: Session, template: str) -> None:
    """Open a new level, without a file, that begins as a bundled one.

    Args:
        session: The app.
        template: Key of `TEMPLATES`.

    Raises:
        LevelError: The bundled level cannot be read.
    """
    label, name = TEMPLATES[template]
    level = load_level(levels_dir() / f"{name}.json")
    # It is the user's own from here on: neither its name nor its proof are those of the original.
    session.open_tab(Document(level.replace(name=f"New {label.lower()}", tags=(), solution=None)))


@functools.cache
def scenes(group: str) -> tuple["SuiteScene", ...]:
    """Return the scenes of a class that have a level to show."""
    from kinetix.scenes import SCENES

    return tuple(s for s in SCENES.values() if s.group == group and s.make_trials())


def open_scene(session: Session, scene_id: str) -> None:
    """Open the first trial of a scene in a new tab and look at what moves in it.

    Args:
        session: The app.
        scene_id: Such as `D10`.

    Raises:
        CommandError: No scene has this id, or it has no level of its own.
    """
    from kinetix.scenes import SCENES

    scene = SCENES.get(scene_id)
    trials = () if scene is None else scene.make_trials()
    if scene is None or not trials:
        raise CommandError(f"The scene {scene_id} has no level to show.")
    level = trials[0].level
    if not level.description:
        level = level.replace(description=scene.note)
    session.open_tab(Document(level))
    moving = tuple(body.id for body in level.bodies if not body.fixed)
    box = selection_box(level, moving)
    if box is None:
        return
    session.tab.fitted = True
    middle = ((box[0] + box[2]) / 2, (box[1] + box[3]) / 2)
    half = (max(box[2] - box[0], _SMALLEST) / 2, max(box[3] - box[1], _SMALLEST) / 2)
    low = (middle[0] - half[0], middle[1] - half[1])
    high = (middle[0] + half[0], middle[1] + half[1])
    session.camera = session.camera.fitted(low, high, margin=60.0)
