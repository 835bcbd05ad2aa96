"""Rows of the Help menu."""

from typing import Final

from editor.actions import about, guide, view
from editor.actions.base import Action

APP: Final = (
    Action(
        id="app.help",
        label="Keys and Help",
        menu="Help",
        group="help",
        keys=("f1",),
        checked=view.is_on("help"),
        run=view.switch("help"),
    ),
    Action(
        id="app.guide",
        label="Guided First Level",
        menu="Help",
        group="help",
        tooltip="Build a car and drive it to its goal, in ten small steps.",
        run=guide.start,
    ),
    Action(
        id="app.documents",
        label="Documentation",
        menu="Help",
        group="help",
        tooltip="Opens the folder of the documents.",
        enabled=lambda session: bool(about.documents()),
        refusal="There are no documents beside this installation.",
        run=about.show_documents,
    ),
    Action(
        id="app.menu",
        label="Open the Menu",
        menu="Help",
        keys=("f10",),
        seen=True,
        tooltip="Arrow keys go through the menus, Enter chooses, Esc closes.",
        run=view.open_menu,
    ),
    Action(
        id="app.palette",
        label="Command Palette",
        menu="Help",
        keys=("ctrl+shift+p",),
        checked=view.is_on("palette"),
        run=view.switch("palette"),
    ),
    Action(
        id="app.preferences",
        label="Preferences…",
        menu="Help",
        keys=("ctrl+,",),
        tooltip="Appearance, editing, simulation, files and keys.",
        checked=view.is_on("preferences"),
        run=view.switch("preferences"),
    ),
    Action(
        id="app.keys",
        label="Change Keys…",
        menu="Help",
        tooltip="Other keys for commands, motors and thrusters.",
        checked=view.is_on("keys"),
        run=view.switch("keys"),
    ),
    Action(
        id="app.about",
        label="About Kinetix",
        menu="Help",
        group="about",
        tooltip="The version, and the folders of levels, agents and settings.",
        run=about.show_about,
    ),
)
