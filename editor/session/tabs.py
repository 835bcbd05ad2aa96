"""Open documents, one of them in front."""

import dataclasses
from collections.abc import Sequence
from pathlib import Path
from typing import overload

from editor.base.camera import Camera
from editor.base.wording import UNTITLED
from editor.documents.document import Document
from editor.play.moment import Moment
from kinetix.level.model import Level


@dataclasses.dataclass(kw_only=True)
class Tab:
    """An open document with its camera."""

    document: Document
    camera: Camera = dataclasses.field(default_factory=Camera)
    fitted: bool = False
    """True if the window has fitted the camera to the viewport once."""
    moment: Moment | None = None
    """A paused episode of the level that is being changed."""

    @property
    def untouched(self) -> bool:
        """True if nothing is lost when another level takes the tab."""
        return self.moment is None and self.document.untouched


class Tabs(Sequence[Tab]):
    """The open tabs from left to right: never none, and one of them is in front."""

    def __init__(self, document: Document) -> None:
        """Open the first one."""
        self._tabs = [Tab(document=document)]
        self.index_in_front = 0

    @overload
    def __getitem__(self, index: int) -> Tab: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Tab]: ...
    def __getitem__(self, index: int | slice) -> Tab | Sequence[Tab]:
        """Return a tab by its place, or several."""
        return self._tabs[index]

    def __len__(self) -> int:
        """Return the number of open tabs."""
        return len(self._tabs)

    @property
    def front(self) -> Tab:
        """The tab in front."""
        return self._tabs[self.index_in_front]

    @property
    def documents(self) -> tuple[Document, ...]:
        """The levels of the tabs, and after each the moment of its episode that is changed."""
        return tuple(
            document
            for tab in self._tabs
            for document in (tab.document, tab.moment and tab.moment.document)
            if document is not None
        )

    def open(self, document: Document) -> None:
        """Show a document in a new tab in front; an untouched empty one is replaced."""
        camera = dataclasses.replace(self.front.camera, centre=(2.5, 2.5))
        tab = Tab(document=document, camera=camera)
        shown = self.front.document if self.front.moment is None else self.front.moment.document
        if self.front.untouched and not shown.level.bodies:
            self._tabs[self.index_in_front] = tab
        else:
            self._tabs.append(tab)
            self.index_in_front = len(self._tabs) - 1

    def close(self, tab: Tab) -> None:
        """Take a tab away; the last one leaves an empty level."""
        index = self._tabs.index(tab)
        del self._tabs[index]
        if not self._tabs:
            self._tabs.append(Tab(document=Document(Level(name=UNTITLED)), camera=tab.camera))
        if self.index_in_front > index or self.index_in_front >= len(self._tabs):
            self.index_in_front = max(self.index_in_front - 1, 0)

    def locate(self, path: Path) -> int | None:
        """Return the place of the tab that shows a file, or None."""
        for index, tab in enumerate(self._tabs):
            if tab.document.path is not None and tab.document.path.resolve() == path.resolve():
                return index
        return None
