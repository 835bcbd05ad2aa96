"""State of the gallery: search, folder, selection, the set being assembled."""

import dataclasses
from collections.abc import Generator, Sequence
from pathlib import Path

from editor.gallery.card import Card
from editor.gallery.export import SetPlan
from editor.gallery.filing import MovedFile
from editor.gallery.library import Library
from editor.gallery.results import Results
from editor.gallery.search import Wish, wanted


@dataclasses.dataclass(kw_only=True)
class FileWork:
    """Something that is done to many files, a part in every frame."""

    title: str
    total: int
    """Number of files."""
    steps: Generator[None]
    """Does one file a step."""
    done: int = 0
    """Number of files that are finished."""


@dataclasses.dataclass(kw_only=True)
class GalleryView:
    """The gallery's state; the panel and the actions change it freely."""

    open: bool = False
    wish: Wish = dataclasses.field(default_factory=Wish)
    folder: Path | None = None
    """Show only what lies below it; None: everything."""
    selection: tuple[str, ...] = ()
    """Paths of the chosen cards, in the order of choosing."""
    focus: str | None = None
    """Path of the card that the arrow keys move from."""
    columns: int = 1
    """Cards in a row, as the panel laid them out: what Up and Down move by."""
    rows: int = 1
    """Rows in sight: what Page Up and Page Down move by."""
    searching: bool = False
    """The search field takes the keyboard in the next frame; the panel clears it."""
    begun: str = ""
    """Characters typed before the search field had the keyboard; the panel passes them to it."""
    scroll: bool = False
    """Bring the focus into sight; the panel clears it."""
    tray: dict[str, float] = dataclasses.field(default_factory=dict)
    """Paths of the set being put together, with their weights."""
    tray_before: dict[str, float] | None = None
    """The set that was there before the last one that took its place as a whole."""
    proposed: SetPlan = dataclasses.field(default_factory=SetPlan)
    """Form that the next export begins with: that of the set that was taken or written last."""
    plan: SetPlan | None = None
    """Form of the export, while that is being asked."""
    exporting: Path | None = None
    """The set that is being written in the background."""
    work: FileWork | None = None
    """The copying, moving or deleting that is under way, while it takes more than a frame."""
    moved: list[tuple[MovedFile, ...]] = dataclasses.field(default_factory=list)
    """Files that were deleted or moved, the last ones at the end, to bring them back."""
    thrown_weights: dict[Path, float] = dataclasses.field(default_factory=dict)
    """Weights in the set of deleted files, by where they were."""
    _shown: tuple[tuple[object, ...], list[Card]] | None = None
    _chosen: tuple[tuple[str, ...], list[Card], list[Card]] | None = None
    """The selection and the cards shown, as they were last, and what is chosen of them."""

    def shown(self, library: Library, results: Results) -> list[Card]:
        """Return the cards that the wish wants, worked out once for each change.

        What another wish or another folder hides is no longer selected.
        """
        key = (self.wish, self.folder, library.revision, results.revision)
        before = self._shown[0] if self._shown else key
        if self._shown is None or before != key:
            cards: Sequence[Card] = library.cards
            if self.folder is not None:
                cards = [card for card in cards if card.file.is_relative_to(self.folder)]
            self._shown = (key, wanted(cards, self.wish, results))
            if before[:2] != key[:2]:
                self.selection = tuple(card.path for card in self._seen(self._shown[1]))
        return self._shown[1]

    def chosen(self, library: Library, results: Results) -> list[Card]:
        """Return the cards that are selected and in sight, or would be after scrolling."""
        shown, old = self.shown(library, results), self._chosen
        if old is None or old[0] is not self.selection or old[1] is not shown:
            self._chosen = old = (self.selection, shown, self._seen(shown))
        return old[2]

    def _seen(self, shown: Sequence[Card]) -> list[Card]:
        by_path = {card.path: card for card in shown}
        return [by_path[path] for path in self.selection if path in by_path]

    def renamed(self, old: str, new: str) -> None:
        """Let a level that has another path now keep its place and weight in the sets."""
        self.tray = _renamed(self.tray, old, new)
        if self.tray_before is not None:
            self.tray_before = _renamed(self.tray_before, old, new)

    def click(self, cards: Sequence[Card], path: str, *, toggle: bool, extend: bool) -> None:
        """Choose a card as lists do: alone, with Ctrl besides others, with Shift up to it."""
        paths = [card.path for card in cards]
        if extend and self.focus in paths and path in paths:
            a, b = sorted((paths.index(self.focus), paths.index(path)))
            self.selection = tuple(paths[a : b + 1])
            return
        if toggle:
            kept = tuple(one for one in self.selection if one != path)
            self.selection = kept if path in self.selection else (*kept, path)
        else:
            self.selection = (path,)
        self.focus = path

    def search(self, begun: str = "") -> None:
        """Let the search field take the keyboard, and what was typed already."""
        self.searching, self.begun = True, self.begun + begun

    def to_cards(self, cards: Sequence[Card]) -> None:
        """Go from the search to the cards: to the first, unless one of them is chosen."""
        if self.focus not in {card.path for card in cards}:
            self.focus, self.selection = None, ()
        if not self.selection:
            self.move(cards, 0)

    def move(self, cards: Sequence[Card], steps: int) -> None:
        """Go on by some cards from the focus, within the ends."""
        if not cards:
            return
        paths = [card.path for card in cards]
        at = paths.index(self.focus) if self.focus in paths else -1
        at = min(max(at + steps, 0), len(paths) - 1) if at >= 0 else 0
        self.focus, self.selection, self.scroll = paths[at], (paths[at],), True


def _renamed(tray: dict[str, float], old: str, new: str) -> dict[str, float]:
    return {new if path == old else path: weight for path, weight in tray.items()}
