"""Things that must stand: walls, pyramids, towers, heaps that fill a size, shelves."""

from kinetix.level.builder import LevelBuilder
from kinetix.level.geometry import FLOOR_TOP
from kinetix.scenes.model import SuiteScene, Trial

FLOOR = FLOOR_TOP
"""Height of the arena's floor [m]."""


def wall(columns: int, rows: int, size: float, left: float, name: str) -> Trial:
    """A wall of square boxes in columns, its left side at `left` [m]."""
    b = LevelBuilder("Wall")
    for row in range(rows):
        for column in range(columns):
            b.rectangle(left + (column + 0.5) * size, FLOOR + (row + 0.5) * size, size, size)
    return Trial(level=b.build(), duration=10.0, name=name)


def pyramid(rows: int, size: float, name: str = "") -> Trial:
    """A pyramid of boxes that touch each other."""
    b = LevelBuilder("Pyramid")
    for row in range(rows):
        for column in range(rows - row):
            x = 2.5 + size * (column - (rows - 1 - row) / 2)
            b.rectangle(x, FLOOR + (row + 0.5) * size, size, size)
    return Trial(level=b.build(), duration=10.0, name=name)


def _walls() -> tuple[Trial, ...]:
    return tuple(
        wall(columns, rows, size, left, f"{columns}×{rows} of {size} m {place}")
        for columns, rows in ((2, 2), (4, 2))
        for size in (0.2, 0.3, 0.4, 0.5, 0.6)
        for left, place in ((0.0, "at the wall"), (1.2, "free"))
    )


def _pyramids() -> tuple[Trial, ...]:
    return tuple(
        pyramid(rows, size, f"{rows} rows of {size} m")
        for rows in (2, 3, 4)
        for size in (0.2, 0.3, 0.4, 0.6)
    )


def _bond() -> tuple[Trial, ...]:
    b = LevelBuilder("Wall in bond")
    for row in range(6):
        for column in range(4 - row % 2):
            x = 1.0 + 0.4 * (column + 0.5 + row % 2 / 2)
            b.rectangle(x, FLOOR + 0.2 * (row + 0.5), 0.4, 0.2)
    return (Trial(level=b.build(), duration=10.0),)


def _full_size() -> tuple[Trial, ...]:
    def trial(gap: float) -> Trial:
        b = LevelBuilder("Everything that fits")
        for row in range(2):
            for column in range(4):
                b.rectangle(1.2 + (0.5 + gap) * column, FLOOR + 0.25 + 0.5 * row, 0.5, 0.5)
        for column in range(4):
            b.circle(1.2 + (0.5 + gap) * column, FLOOR + 1.25, 0.25)
        return Trial(level=b.build(), duration=10.0, name="flush" if gap == 0 else "apart")

    return trial(0.0), trial(0.05)


def tower(count: int, ratio: float, name: str) -> Trial:
    """Boxes of .4 m, the odd ones `ratio` times heavier."""
    b = LevelBuilder("Tower", arena=False)
    b.rectangle(0, -0.5, 10, 1, fixed=True)
    for k in range(count):
        b.rectangle(0, 0.2 + 0.4 * k, 0.4, 0.4, density=ratio if k % 2 else 1.0)
    return Trial(level=b.build(), duration=10.0, name=name)


def _shelf() -> tuple[Trial, ...]:
    def trial(density: float) -> Trial:
        b = LevelBuilder("Shelf")
        floor = FLOOR
        for _ in range(3):
            board = b.rectangle(2.5, floor + 0.45, 1.0, 0.1)
            for x in (2.05, 2.95):
                b.weld(b.rectangle(x, floor + 0.2, 0.1, 0.4), board, (x, floor + 0.4))
            floor += 0.5
        b.rectangle(2.5, floor + 0.15, 0.3, 0.3, density=density)
        return Trial(level=b.build(), duration=10.0, name=f"load {density:g}")

    return trial(1.0), trial(10.0), trial(50.0)


STACKS = (
    SuiteScene(
        id="U1",
        name="walls",
        group="built",
        core=False,
        sized=True,
        make_trials=_walls,
        note="Walls of up to 4×2 boxes of any size, at the arena's wall and free.",
    ),
    SuiteScene(
        id="U2",
        name="pyramids",
        group="built",
        core=False,
        sized=True,
        make_trials=_pyramids,
        note="Pyramids of up to four rows of boxes that touch.",
    ),
    SuiteScene(
        id="U3",
        name="wall in bond",
        group="built",
        core=False,
        sized=True,
        make_trials=_bond,
        note="Twenty-one bricks, each on two.",
    ),
    SuiteScene(
        id="U4",
        name="full size",
        group="built",
        core=False,
        sized=True,
        make_trials=_full_size,
        note="Eight boxes and four discs that fill size l, at rest.",
    ),
    SuiteScene(
        id="U5",
        name="light and heavy",
        group="built",
        core=False,
        make_trials=lambda: (tower(8, 20.0, "8 boxes, 1:20"), tower(6, 58.0, "6 boxes, 1:58")),
        note="Towers of light and heavy boxes in turn.",
    ),
    SuiteScene(
        id="U6",
        name="shelf",
        group="built",
        core=False,
        make_trials=_shelf,
        note="Three welded storeys under a box that is up to 50 times denser.",
    ),
)
