"""The least shift onto a slanted edge, looked for among what is near."""

import math
import random

from editor.editing.flush import flush
from tests.pace import share_of


def spread(draw, count, width):
    return tuple((draw.uniform(0, width), draw.uniform(0, width)) for _ in range(count))


def onto(point, segment):
    """Return the shift of a point onto an edge."""
    (x, y), ((px, py), (qx, qy)) = point, segment
    dx, dy = qx - px, qy - py
    along = min(max(((x - px) * dx + (y - py) * dy) / (dx * dx + dy * dy), 0.0), 1.0)
    return px + along * dx - x, py + along * dy - y


def test_the_nearest_of_all_is_found():
    draw = random.Random(3)
    for _ in range(50):
        points, corners = spread(draw, 12, 2.0), spread(draw, 16, 2.0)
        segments = tuple(zip(corners[::2], corners[1::2], strict=True))
        shifts = [onto(point, segment) for segment in segments for point in points]
        nearest = min(shifts, key=lambda shift: math.hypot(*shift))
        found = flush(points, segments, 0.08)
        assert found == (nearest if math.hypot(*nearest) <= 0.08 else None)


def test_what_is_far_away_costs_nothing():
    draw = random.Random(4)
    points = spread(draw, 4000, 40.0)
    segments = tuple(((x, y), (x + 0.1, y + 0.05)) for x, y in spread(draw, 4000, 40.0))
    assert flush(points, segments, 0.08) is not None
    took = share_of(2.0, lambda: flush(points, segments, 0.08), tries=3)
    assert took <= 1  # one by one it takes more
