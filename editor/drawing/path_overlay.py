"""The ways of all attempts of an evaluation over the level, coloured by how they end."""

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from editor.drawing.vectors import Painter
from editor.toolkit.appearance import COLOURS, alpha, u32
from editor.toolkit.modes import OUTCOME_LOOK
from editor.toolkit.widgets import px

if TYPE_CHECKING:
    from editor.session import Session

_MOST: Final = 300
"""Ways that are drawn; more only hide each other."""


def paint_paths(session: "Session", painter: Painter) -> None:
    """Draw the ways of the green shape on the level that they belong to.

    Args:
        session: The app.
        painter: Where to draw.
    """
    ways = session.viewer.ways
    if ways is None or ways.paths.level_hash != session.document.hash:
        return
    draw, camera = painter.draw, painter.camera
    paths, lit, ending = ways.paths, ways.lit, ways.ending
    group = None if ending is None else frozenset(paths.endings[ending].attempts)
    order = [k for k in range(min(len(paths.outcomes), _MOST)) if k != lit]
    for k in [*order, lit] if lit is not None and lit < len(paths.outcomes) else order:
        outcome = paths.outcomes[k]
        if group is not None and k not in group and k != lit:
            continue
        if ways.outcomes and outcome not in ways.outcomes:
            continue
        places: list[Any] = [camera.to_screen((x, y)) for x, y in paths.position[k].tolist()]
        colour = COLOURS.of(OUTCOME_LOOK[outcome][2])
        strong = k == lit
        shade = u32(colour if strong else alpha(colour, 0.45))
        draw.add_polyline(places, shade, px(3.5 if strong else 1.75), 0)
        draw.add_circle_filled(places[-1], px(4), u32(colour))
    parting = paths.parting if ending is None else paths.endings[ending].parting
    if parting is not None:
        at = int(np.searchsorted(paths.step, parting))
        for k in order[:_MOST]:
            if group is not None and k not in group:
                continue
            x, y = paths.position[k][min(at, paths.position.shape[1] - 1)].tolist()
            draw.add_circle(camera.to_screen((x, y)), px(3), u32(COLOURS.backdrop), 0, px(1.5))
