"""The rubber band: left to right takes what lies wholly inside, right to left what it touches."""

from editor.base.events import Pointer, PointerEvent
from editor.base.overlay import Box, Style
from editor.editing.picking import inside
from editor.editing.tools.base import Feedback, Gesture, ToolContext, is_drag


def rubber_band(session: ToolContext, press: PointerEvent) -> Gesture:
    """Select what a rectangle takes; Shift adds; a click selects nothing.

    Leaving the gesture half-way puts the old selection back.
    """
    before = session.selection
    kept = before if press.modifiers.shift else ()
    document = session.document
    without = document.locked | document.hidden
    finished = False
    feedback = Feedback()
    try:
        while True:
            event = yield feedback
            touching = event.world[0] < press.world[0]
            low = tuple(min(press.world[k], event.world[k]) for k in (0, 1))
            high = tuple(max(press.world[k], event.world[k]) for k in (0, 1))
            taken = ()
            if is_drag(session, press.screen, event.screen):
                box = (low[0], low[1], high[0], high[1])
                taken = inside(document.level, box, touching=touching, without=without)
            session.selection = (*kept, *taken)
            if event.kind is Pointer.RELEASE:
                finished = True
                session.last_click = None
                return None
            style = Style.MARQUEE_TOUCHING if touching else Style.MARQUEE_CONTAINED
            mark = Box(low=(low[0], low[1]), high=(high[0], high[1]), style=style)
            feedback = Feedback(marks=(mark,))
    finally:
        if not finished:
            session.selection = before
