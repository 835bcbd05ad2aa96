"""Search and order of cards: words, tags, sizes, switches."""

import dataclasses
from collections.abc import Iterable, Sequence
from typing import Final, Literal

from editor.gallery.card import Card
from editor.gallery.results import Results

Sort = Literal["name", "date", "solve rate", "size"]
SORTS: Final[tuple[Sort, ...]] = ("name", "date", "solve rate", "size")
SIZE_ORDER: Final = ("s", "m", "l", "locomotion", "other")


@dataclasses.dataclass(frozen=True, kw_only=True)
class Wish:
    """Conditions of a search. Every condition must hold; an empty one always does."""

    words: str = ""
    """Each word must occur in name, file name, description or tags."""
    tags: frozenset[str] = frozenset()
    """All of them."""
    sizes: frozenset[str] = frozenset()
    """One of them (`s`, `m`, `l`, `locomotion`, `other`)."""
    thruster: bool | None = None
    """With, without, or either."""
    problems: bool | None = None
    """With errors or warnings, without, or either."""
    solution: bool | None = None
    """With a recorded solution, without, or either."""
    solved_by: str = ""
    """Won at least once by this player."""
    unsolved_by: str = ""
    """Never won by this player, as far as is known."""
    sort: Sort = "name"
    descending: bool = False

    @property
    def filters(self) -> int:
        """Number of conditions besides the words."""
        switches = (self.thruster, self.problems, self.solution)
        set_switches = sum(value is not None for value in switches)
        return (
            set_switches
            + bool(self.tags)
            + bool(self.sizes)
            + bool(self.solved_by)
            + bool(self.unsolved_by)
        )


def wanted(cards: Iterable[Card], wish: Wish, results: Results) -> list[Card]:
    """Return the cards that fulfil a wish, in its order; equal ones by name and path."""
    words = wish.words.lower().split()
    kept = [card for card in cards if _fits(card, wish, words, results)]
    kept.sort(key=lambda card: (card.name.lower(), card.path))
    if wish.sort == "date":
        # The newest first is what people mean by the order of dates.
        kept.sort(key=lambda card: -card.modified_ns)
    elif wish.sort == "solve rate":
        kept.sort(key=lambda card: -best_rate(card, results))
    elif wish.sort == "size":
        kept.sort(key=lambda card: SIZE_ORDER.index(card.size_class))
    return kept[::-1] if wish.descending else kept


def best_rate(card: Card, results: Results) -> float:
    """Return the best solve rate of anybody on a level; -1 when nobody has tried."""
    return max((r.solve_rate for r in results.of(card.sha256).values()), default=-1.0)


def tag_counts(cards: Sequence[Card]) -> list[tuple[str, int]]:
    """Return the tags of some cards with how often each occurs, the commonest first."""
    counts: dict[str, int] = {}
    for card in cards:
        for tag in card.tags:
            counts[tag] = counts.get(tag, 0) + 1
    return sorted(counts.items(), key=lambda pair: (-pair[1], pair[0]))


def _fits(card: Card, wish: Wish, words: list[str], results: Results) -> bool:
    if words:
        text = " ".join((card.name, card.file.stem, card.description, *card.tags)).lower()
        if not all(word in text for word in words):
            return False
    if wish.sizes and card.size_class not in wish.sizes:
        return False
    if not wish.tags <= set(card.tags):
        return False
    troubled = bool(card.errors or card.warnings or card.fault)
    switches = (
        (wish.thruster, card.thrusters > 0),
        (wish.problems, troubled),
        (wish.solution, card.solved),
    )
    if any(value is not None and value != fact for value, fact in switches):
        return False
    return _solved(card, wish, results)


def _solved(card: Card, wish: Wish, results: Results) -> bool:
    if not (wish.solved_by or wish.unsolved_by):
        return True
    winners = {t.player for t, record in results.of(card.sha256).items() if record.solved}
    if wish.solved_by and wish.solved_by not in winners:
        return False
    return not (wish.unsolved_by and wish.unsolved_by in winners)
