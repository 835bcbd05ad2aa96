"""Pages of a curriculum's history on disk: the best levels of a moment, what left, and why."""

import io
import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import msgspec
import numpy as np

from kinetix.errors import KinetixError
from kinetix.files.arrays import read_npz
from kinetix.files.atomic import write_atomically
from kinetix.level.codec import dumps, loads
from kinetix.level.model import Level

FOLDER: Final = "curriculum"
"""In the run's directory."""
FORMAT: Final = "kinetix-curriculum"
VERSION: Final = 1
MOST_PAGES: Final = 96
"""Beyond it every second page but the newest is dropped: a history is a few MB, however long."""


class ListedLevel(msgspec.Struct, frozen=True, kw_only=True):
    """A level of a page."""

    serial: int
    score: float | None
    learnability: float | None
    solve_rate: float | None
    episodes: int
    born: int
    """Update in which it came in."""
    kind: str
    ancestry: tuple[int, ...] = ()
    """Serial numbers, the parent first."""


class GoneLevel(msgspec.Struct, frozen=True, kw_only=True):
    """A level of the page before that left."""

    serial: int
    update: int
    reason: str
    by: int
    score: float | None
    solve_rate: float | None


class PageHead(msgspec.Struct, frozen=True, kw_only=True):
    """Head of a page."""

    format: str = FORMAT
    version: int = VERSION
    algorithm: str
    update: int
    env_steps: int
    capacity: int
    filled: int
    entered: int
    """Levels that came in since the page before."""
    left: int
    score_quartiles: tuple[float, float, float] | None
    levels: tuple[ListedLevel, ...]
    gone: tuple[GoneLevel, ...] = ()


class BufferPage(msgspec.Struct, frozen=True, kw_only=True):
    """A page with the levels that it lists, in their order."""

    head: PageHead
    levels: tuple[Level, ...]


def page_path(run: Path, update: int) -> Path:
    """Return where the page of an update lies."""
    return run / FOLDER / f"{update:09d}.npz"


def page_updates(run: Path) -> list[int]:
    """Return the updates of which there are pages, in order; none where there is no history."""
    folder = run / FOLDER
    if not os.path.isdir(folder):
        return []
    stems = [path.stem for path in folder.glob("*.npz")]
    return sorted(int(stem) for stem in stems if stem.isascii() and stem.isdecimal())


def write_page(
    run: Path, head: PageHead, levels: Sequence[Level], slots: dict[str, np.ndarray]
) -> None:
    """Write a page, and drop every second one where there are too many.

    Args:
        run: The run's directory.
        head: Totals of the page.
        levels: Those that it lists.
        slots: Of the ledger, so that a run that goes on knows who is who.
    """
    texts = [dumps(level).encode() for level in levels]
    arrays: dict[str, Any] = {
        "page": np.frombuffer(msgspec.json.encode(head), np.uint8),
        "level": np.frombuffer(b"".join(texts), np.uint8),
        "level_end": np.cumsum([len(text) for text in texts], dtype=np.int64),
        **slots,
    }
    packed = io.BytesIO()
    np.savez_compressed(packed, **arrays)  # pyright: ignore[reportArgumentType]
    path = page_path(run, head.update)
    path.parent.mkdir(exist_ok=True)
    write_atomically(path, packed.getvalue())
    updates = page_updates(run)
    if len(updates) > MOST_PAGES:
        for update in updates[1:-2:2]:
            page_path(run, update).unlink(missing_ok=True)


def forget_later_pages(run: Path, update: int) -> None:
    """Delete the pages after an update: the run goes on from there."""
    for later in page_updates(run):
        if later > update:
            page_path(run, later).unlink(missing_ok=True)


def read_page(run: Path, update: int) -> BufferPage:
    """Return a page.

    Raises:
        KinetixError: The page is missing or damaged; one sentence.
    """
    path = page_path(run, update)
    arrays = read_npz(path, "curriculum", only=("page", "level", "level_end"))
    try:
        head = msgspec.convert(json.loads(arrays["page"].tobytes()), PageHead)
        if head.format != FORMAT or head.version != VERSION:
            raise KinetixError(f"{path}: expected {FORMAT} version {VERSION}")
        text, levels, start = arrays["level"].tobytes(), [], 0
        for end in arrays["level_end"].tolist():
            levels.append(loads(text[start:end].decode(), f"{path}: level {len(levels)}"))
            start = end
    except KeyError as error:
        raise KinetixError(f"{path}: expected a page of a curriculum: {error} is missing") from (
            error
        )
    except (ValueError, TypeError) as error:
        raise KinetixError(f"{path}: expected a page of a curriculum: {error}") from error
    if len(levels) != len(head.levels):
        raise KinetixError(f"{path}: expected {len(head.levels)} levels, found {len(levels)}")
    return BufferPage(head=head, levels=tuple(levels))


def read_slots(run: Path, update: int) -> dict[str, np.ndarray]:
    """Return the slots of the buffer on a page.

    Raises:
        KinetixError: The page is missing or damaged; one sentence.
    """
    arrays = read_npz(page_path(run, update), "curriculum")
    return {name: value for name, value in arrays.items() if name.startswith("slot_")}
