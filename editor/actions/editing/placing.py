"""Drawing without a pointer: a shape of standard size in the middle of the view."""

from typing import Final

from editor.actions.editing.edit import PASTE_SHIFT
from editor.documents.commands.bodies import AddBody
from editor.documents.commands.clip import Clip, free_shift
from editor.editing.tools.rectangle import rectangle
from editor.session import Session
from kinetix.level.model import Body, Circle, Polygon, Shape

_USUAL: Final[dict[str, Shape]] = {
    "rectangle": rectangle(0.6, 0.4),
    "circle": Circle(radius=0.2),
    "triangle": Polygon(vertices=((0.0, 0.3), (-0.3, -0.15), (0.3, -0.15))),
}
"""By tool, about the centre of mass [m]."""
_DECIMALS: Final = 1
"""Decimals of the place in messages [m]."""


def can_place(session: Session) -> bool:
    """Return whether a tool that draws shapes is in the hand."""
    return session.editing and session.tool.id in _USUAL


def place(session: Session) -> None:
    """Put a shape there and select it; it covers none exactly. Select takes over as usual."""
    x, y = session.camera.centre
    body = Body(id=1, shape=_USUAL[session.tool.id], position=(0.0, 0.0))
    middle = round(x, _DECIMALS), round(y, _DECIMALS)
    at = free_shift(Clip(bodies=(body,)), middle, session.document.level, PASTE_SHIFT)
    session.execute(AddBody(body=body.replace(position=at)))
    session.tool_done()
