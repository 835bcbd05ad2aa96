"""Rows of the Level menu."""

from typing import Final

from editor.actions.base import Action, Context, editing
from editor.actions.editing import level
from editor.actions.gallery import gallery, level_sets
from editor.actions.playing import solution
from editor.session import Session

EDIT: Final = Context.EDIT


def _has_file(session: Session) -> bool:
    return session.document.path is not None


LEVEL: Final = (
    Action(
        id="level.random",
        label="Random Level",
        menu="Level",
        keys=("ctrl+r",),
        context=EDIT,
        tooltip="A level of the current size; each time another seed.",
        enabled=editing,
        run=level.random_level,
    ),
    Action(
        id="level.random_machine",
        label="Random Machine",
        menu="Level",
        context=EDIT,
        tooltip="A car, an arm, a rocket, … with a task, of the current size.",
        enabled=editing,
        run=level.random_machine,
    ),
    Action(
        id="level.mutate",
        label="Mutate",
        menu="Level",
        keys=("ctrl+m",),
        context=EDIT,
        tooltip="One random change.",
        enabled=editing,
        run=level.mutate(None),
    ),
    Action(
        id="level.mutate_menu",
        label="Mutate…",
        menu="Level",
        keys=("ctrl+shift+m",),
        context=EDIT,
        tooltip="Choose the kind of change.",
        enabled=editing,
        run=level.mutate_menu,
    ),
    Action(
        id="level.permute",
        label="Permute Order",
        menu="Level",
        context=EDIT,
        tooltip="Shuffles the slots of shapes and joints, as training does.",
        enabled=editing,
        run=level.permute,
    ),
    Action(
        id="level.try_out",
        label="Try It Out",
        menu="Level",
        group="solution",
        context=EDIT,
        tooltip="What happens without any action, and how often random actions win.",
        enabled=level.can_try_out,
        refusal="The level is empty or has errors: see Problems.",
        run=level.try_out,
    ),
    Action(
        id="level.play_solution",
        label="Play the Solution",
        menu="Level",
        group="solution",
        context=Context.LEVEL,
        tooltip="Plays the solution of the level on the timeline; drive on from any moment.",
        enabled=solution.has_solution,
        refusal="The level has no recorded solution.",
        run=solution.play,
    ),
    Action(
        id="level.keep_solution",
        label="Keep as the Solution",
        menu="Level",
        group="solution",
        context=Context.LEVEL,
        tooltip="The episode that you have just won, recorded in the level.",
        enabled=solution.can_keep,
        refusal="Win the level by hand first.",
        run=solution.keep,
    ),
    Action(
        id="level.previous",
        label="Previous Level",
        menu="Level",
        group="browse",
        context=Context.LEVEL,
        keys=("page up",),
        tooltip="Of the same folder.",
        enabled=_has_file,
        refusal="Save the level to a file first.",
        run=level.neighbour(-1),
    ),
    Action(
        id="level.next",
        label="Next Level",
        menu="Level",
        group="browse",
        context=Context.LEVEL,
        keys=("page down",),
        tooltip="Of the same folder.",
        enabled=_has_file,
        refusal="Save the level to a file first.",
        run=level.neighbour(1),
    ),
    Action(
        id="level.gallery",
        label="Gallery",
        menu="Level",
        group="browse",
        keys=("ctrl+g",),
        tooltip="All levels as pictures: search, open and sort them, and build sets.",
        checked=gallery.is_open,
        run=gallery.toggle,
    ),
    Action(
        id="level.export_set",
        label="Export Level Set…",
        menu="Level",
        group="browse",
        tooltip="Chosen levels with weights and a split, for training and evaluation.",
        run=level_sets.ask_export,
    ),
)
