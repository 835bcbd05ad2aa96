"""Parts of a list of levels: without duplicates, for training, for evaluation."""

from collections.abc import Iterable, Sequence

from kinetix.errors import LevelError
from kinetix.level.sets.manifest import SetLevel
from kinetix.wording import plural


def distinct(levels: Iterable[SetLevel]) -> list[SetLevel]:
    """Return the levels without those that equal an earlier one (by hash)."""
    first: dict[str, SetLevel] = {}
    for each in levels:
        first.setdefault(each.sha256, each)
    return list(first.values())


def training_part(levels: Sequence[SetLevel]) -> list[SetLevel]:
    """Return what may be trained on: all but the evaluation parts of sets.

    Raises:
        LevelError: That is nothing.
    """
    chosen = [each for each in levels if each.split != "eval"]
    if levels and not chosen:
        raise LevelError(
            f"{plural(len(levels), 'level')} for evaluation, none to train on: draw another "
            "split with `kinetix levelset split SET --seed 0`, or give the levels without a set"
        )
    return chosen


def evaluation_part(levels: Sequence[SetLevel]) -> list[SetLevel]:
    """Return the evaluation parts of sets; all levels of sets without one."""
    return [each for each in levels if each.split == "eval"] or list(levels)
