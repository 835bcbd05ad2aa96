"""Panels: titled windows that read the session and queue commands."""

import abc
from typing import TYPE_CHECKING, ClassVar

from editor.base.language import tr

if TYPE_CHECKING:
    from editor.session import Session


class Panel(abc.ABC):
    """Draws into the current window; holds no copy of the document's data."""

    id: ClassVar[str]
    title: ClassVar[str]
    icon: ClassVar[str]
    height: ClassVar[float] = 0.0
    """Height that it needs to be of use [px at 100 %]; 0: any will do."""
    measures: ClassVar[bool] = False
    """True if it is looked at together with the level, and nobody edits meanwhile: then a level
    that is shown whole stays so."""

    @property
    def window_name(self) -> str:
        """Title with a stable identity, for docking."""
        return f"{self.icon}  {tr(self.title)}###panel-{self.id}"

    @abc.abstractmethod
    def draw(self, session: "Session") -> None:
        """Draw one frame of it."""
