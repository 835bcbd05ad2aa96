"""Run by test_damage.py: compares what partial drawing leaves with frames drawn whole."""

import sys

import numpy as np

from editor.base.events import Pointer, PointerEvent
from editor.base.prompts import Choice, MenuQuestion
from editor.base.settings import Settings
from editor.hosts.bench.rows import crowded_level
from editor.hosts.offscreen import OffscreenHost
from editor.hosts.renderer import GlRenderer, Window
from editor.session import Session
from editor.toolkit.appearance import COLOURS
from editor.worker.jobs import Worker

WINDOW = Window.LASTS if sys.argv[1] == "window" else Window.FADES


def refuse(request, progress):
    raise AssertionError(f"{request} was asked of the worker by {progress}")


class Host(OffscreenHost):
    def _make_renderer(self):
        self._pictures = GlRenderer(WINDOW)
        return self._pictures


session = Session(settings=Settings(), level=crowded_level(), worker=Worker(perform=refuse))
host = Host(session, size=(1000, 700))
CHOICES = tuple(Choice(id=str(k), label=f"Choice {k}") for k in range(12))
MENU = MenuQuestion(title="Menu", choices=CHOICES, at=(300.0, 420.0), answer=lambda choice: None)
CHANGES = {
    1: lambda: session.ask(MENU),
    4: lambda: session.answer(MENU, None),
    6: lambda: setattr(session, "selection", (3, 4, 5)),
    9: lambda: session.queue("view.debug_draw"),
    12: lambda: session.queue("app.help"),
    16: lambda: setattr(session.view, "help", False),
    18: lambda: session.queue("app.palette"),
    21: lambda: setattr(session.view, "palette", False),
    23: lambda: session.toast("A message"),
    26: lambda: session.queue("edit.duplicate"),
}
for _ in range(12):
    host.step((), 1 / 60)
partial = different = 0
for k in range(30):
    CHANGES.get(k, lambda: None)()
    at = (300 + 12 * k, 250 + 5 * k)
    host.step([PointerEvent(kind=Pointer.MOVE, world=(0, 0), screen=at, button=0)], 1 / 60)
    shown = host.screenshot()
    host._pictures.invalidate()
    whole = host._pictures.pixels(*host.size, COLOURS.backdrop[:3])
    different += int((shown != whole).any())
    partial += int(np.ptp(shown) > 0)
host.close()
session.worker.stop()
sys.stdout.write(f"{different} {partial}\n")
