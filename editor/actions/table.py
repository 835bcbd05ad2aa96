"""The one table of user actions: menus, toolbar, keys, palette, help, replays."""

from typing import Final

from editor.actions.base import Action
from editor.actions.tables.agents import AGENTS
from editor.actions.tables.app import APP
from editor.actions.tables.edit import ARRANGE, EDITS
from editor.actions.tables.file import FILE
from editor.actions.tables.gallery import GALLERY
from editor.actions.tables.level import LEVEL
from editor.actions.tables.run import RUN
from editor.actions.tables.tools import PART_ACTIONS, SWITCHES, TOOL_ACTIONS
from editor.actions.tables.view import VIEW

ACTIONS: Final[tuple[Action, ...]] = (
    *FILE,
    *EDITS,
    *ARRANGE,
    *TOOL_ACTIONS,
    *PART_ACTIONS,
    *VIEW,
    *RUN,
    *AGENTS,
    *SWITCHES,
    *LEVEL,
    *GALLERY,
    *APP,
)
"""All actions, in the order of the menus."""

BY_ID: Final[dict[str, Action]] = {action.id: action for action in ACTIONS}
