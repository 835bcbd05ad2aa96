"""State of the window that is no part of a level."""

import dataclasses


@dataclasses.dataclass(kw_only=True)
class View:
    """View settings besides the level; the window's panels and actions change them freely."""

    scale: float = 1.0
    """Window pixels per pixel at 100 %; the window sets it."""
    interface: bool = True
    """Panels and bars; Tab hides them."""
    panels_in_play: bool = False
    """True if the panels stay while a level is played; Tab brings them back."""
    fullscreen: bool = False
    debug_draw: bool = False
    front: str = ""
    """Id of a panel to bring to the front; the window clears it."""
    field: str = ""
    """Name of a field to type into (`level.gravity.1`); the panel that has it clears it."""
    menu: bool = False
    """True if the first menu is to open; the menu bar clears it."""
    palette: bool = False
    """The command palette."""
    help: bool = False
    keys: bool = False
    """The window in which keys are changed."""
    preferences: bool = False
    """The window of all settings."""
    settled: bool = False
    """True if the panels stand where they stay: while they are put up, each is in front once."""
    edit_arena: bool = False
    """True if floor, walls and ceiling can be selected on the canvas."""
    layout: str = ""
    """A layout that the window shall take (`edit`, `play`, `evaluate`, or a kept one's name)."""
    layout_name: str = ""
    """The name under which the window shall keep its present layout."""

    @property
    def covered(self) -> bool:
        """True if the help, the keys or the preferences lie over the panels."""
        return self.help or self.keys or self.preferences
