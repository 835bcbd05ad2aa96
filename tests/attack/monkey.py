"""A monkey at the editor: actions, keys, clicks, drags, drops and text in any order, by a seed.

    python -m tests.attack.monkey --minutes 10 --seed 0

Whatever it does: nothing is reported as a fault of the app, a level saves and opens again as it
was, and undo leads back to its beginning.
"""

import argparse
import os
import random
import sys
import tempfile
import time
from pathlib import Path

from editor import actions
from editor.base import events
from editor.base.settings import Settings
from editor.documents import files
from editor.documents.autosaves import Autosaves
from editor.documents.document import Document
from editor.gallery.results import Results
from editor.hosts.headless import HeadlessHost
from editor.session import Session
from editor.toolkit.keys import IMGUI
from kinetix.level.codec import load_level
from kinetix.level.model import Level
from kinetix.paths import levels_dir
from tests.attack.levels import native_levels
from tests.attack.mutate import Mutator

STEPS = 150
"""Things that one monkey does."""
_LEVELS = ("s/first_flight", "s/circus_act", "m/leapfrog", "l/rover_ridge")
_TEXTS = ("0", "-1", "1e999", "nan", "", "abc", "灯", "\x1b", "9" * 400, "1/0", "2*(3", "\ud800")
_SPARED = (
    *("file.quit", "run.", "agent.", "trial.", "solution.", "gallery.play_agent"),
    *("gallery.evaluate", "level.evaluate", "level.random", "level.mutate", "level.try_out"),
    "level.play_solution",
)
"""Actions that end the app, start JAX or a browser."""
_PLAYING = frozenset({"f5", "f6", "f7", "f8", "p", "return", "space"})
"""Keys that start JAX."""
_QUITTING = (("left ctrl", "q"), ("left alt", "f4"))
_SIZES = ((1280, 800), (800, 600), (1920, 1080), (320, 240))
_WINDOW = (1330.0, 850.0)
"""Places are chosen up to here [px], and a little outside on the other side."""


class Monkey:
    """Does anything at all, by a seed."""

    def __init__(self, seed: int, folder: Path) -> None:
        """Open one of four levels.

        Args:
            seed: Of everything that it does.
            folder: For files that it drops and saves.
        """
        self.random = random.Random(seed)
        self.did: list[str] = []
        self._folder = folder
        self.session = Session(
            settings=Settings(),
            level=load_level(self.random.choice(_LEVELS)),
            results=Results(stored=False),
            autosaves=Autosaves(stored=False),
        )
        self.host = HeadlessHost(self.session)
        self.host.frames(4)
        self._ids = [each.id for each in actions.ACTIONS if not each.id.startswith(_SPARED)]
        self._keys = sorted(set(IMGUI) - _PLAYING)

    def step(self) -> None:
        """Do one thing."""
        deeds = (self._act, self._press_keys, self._drag, self._type, self._disturb)
        self.random.choices(deeds, weights=(4, 3, 6, 2, 1))[0]()

    def _act(self) -> None:
        name = self.random.choice(self._ids)
        self.did.append(name)
        with self.session.guard():
            actions.run(self.session, name)
        self.host.frames()

    def _press_keys(self) -> None:
        held = self.random.choice(((), (), ("left ctrl",), ("left shift",), ("left alt",)))
        key = self.random.choice(self._keys)
        if (*held, key) in _QUITTING:
            return
        self.did.append(" ".join((*held, key)))
        for pressed, keys in ((True, (*held, key)), (False, (key, *held))):
            for one in keys:
                self.host.frames(1, events.KeyEvent(key=one, pressed=pressed))

    def _drag(self) -> None:
        button = self.random.choice((1, 1, 1, 2, 3))
        places = [self._place() for _ in range(self.random.choice((1, 2, 3)))]
        self.did.append(f"drag {button} {[(round(x), round(y)) for x, y in places]}")
        self._point(events.Pointer.MOVE, places[0], 0)
        self._point(events.Pointer.PRESS, places[0], button)
        for place in places[1:]:
            self._point(events.Pointer.MOVE, place, button)
        self._point(events.Pointer.RELEASE, places[-1], button)

    def _type(self) -> None:
        text = self.random.choice(_TEXTS)
        self.did.append(f"text {text!r:.20}")
        self.host.frames(1, events.TextEvent(text=text))
        if self.random.random() < 0.5:
            for pressed in (True, False):
                self.host.frames(1, events.KeyEvent(key="tab", pressed=pressed))

    def _disturb(self) -> None:
        """Turn the wheel, pinch, resize, lose the focus, drop a file."""
        match self.random.randrange(5):
            case 0:
                dy = self.random.choice((-3.0, 3.0, 1e30))
                event = events.WheelEvent(dy=dy, screen=self._place())
            case 1:
                factor = self.random.choice((0.0, 0.5, 2.0, 1e30))
                event = events.PinchEvent(factor=factor, screen=self._place())
            case 2:
                width, height = self.random.choice(_SIZES)
                self.host.size = width, height
                event = events.ResizeEvent(width=width, height=height)
            case 3:
                event = events.FocusEvent(focused=self.random.random() < 0.5)
            case _:
                event = events.DropEvent(path=str(self._file()))
        self.did.append(f"{event!r:.80}")
        self.host.frames(1, event)

    def _file(self) -> Path:
        """A level of the app, a good file, a damaged one, or none at all."""
        path = self._folder / "dropped.json"
        sample = self.random.choice(native_levels())
        match self.random.randrange(4):
            case 0:
                return self.random.choice(sorted(levels_dir().glob("?/*.json")))
            case 1:
                path.write_bytes(sample)
            case 2:
                path.write_bytes(Mutator(self.random.getrandbits(32)).damaged(sample))
            case _:
                return self._folder / "nothing.json"
        return path

    def _place(self) -> tuple[float, float]:
        width, height = _WINDOW
        return self.random.uniform(-50, width), self.random.uniform(-50, height)

    def _point(self, kind: events.Pointer, at: tuple[float, float], button: int) -> None:
        world = self.session.camera.to_world(at)
        event = events.PointerEvent(kind=kind, world=world, screen=at, button=button)
        self.host.frames(1, event)

    def check(self) -> None:
        """Compare with what must hold."""
        reports = sorted(Path(os.environ["XDG_STATE_HOME"]).rglob("crashes/*"))
        assert not reports, reports[-1].read_text()[-1500:]
        for tab in self.session.tabs:
            _check(tab.document, self._folder / "saved.json")

    def close(self) -> None:
        """End what goes on in the background."""
        for worker in (self.session.worker, self.session.evaluator, self.session.library):
            worker.stop(10)
        self.session.autosaves.end()
        self.host.close()


def _check(document: Document, path: Path) -> None:
    """Undo to the beginning, redo what was undone, save, open again."""
    newest, first = document.level, document.history.entries[0].value
    undone = 0
    while document.undo() is not None:
        undone += 1
    assert _content(document.level) == _content(first), "undo leads elsewhere"
    for _ in range(undone):
        document.redo()
    assert _content(document.level) == _content(newest), "redo leads elsewhere"
    files.save_document(document, path, "kinetix-level")
    assert _content(document.level.replace(size=newest.size)) == _content(newest), "saving loses"
    assert files.open_document(path).level == document.level, "saving and opening changes it"


def _content(level: Level) -> Level:
    """A level without its counter."""
    return level.replace(next_id=1)


def play(seed: int, folder: Path, steps: int = STEPS) -> None:
    """Let a monkey play.

    Raises:
        AssertionError: Something went wrong; the message ends with what it did last.
    """
    monkey = Monkey(seed, folder)
    try:
        for _ in range(steps):
            monkey.step()
        monkey.check()
    except Exception as error:
        last = "; ".join(monkey.did[-8:])
        raise AssertionError(f"seed {seed}: {error!r:.1500} after {last:.600}") from error
    finally:
        monkey.close()


def main() -> int:
    """Play with one seed after the other; 1 if anything went wrong."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--seed", type=int, default=0, help="of the first monkey")
    parser.add_argument("--monkeys", type=int, help="how many at most")
    options = parser.parse_args()
    until, seed, wrong = time.monotonic() + 60 * options.minutes, options.seed, 0
    while time.monotonic() < until and seed - options.seed != options.monkeys:
        with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as place:
            for name in ("STATE", "CONFIG", "DATA", "CACHE"):
                os.environ[f"XDG_{name}_HOME"] = str(Path(place) / name.lower())
            os.chdir(place)
            try:
                play(seed, Path(place))
            except AssertionError as error:
                wrong += 1
                sys.stdout.write(f"{error}\n")
                sys.stdout.flush()
        seed += 1
    count = seed - options.seed
    sys.stdout.write(f"{count} monkeys did {count * STEPS:,} things, {wrong} went wrong\n")
    sys.stdout.flush()
    os._exit(1 if wrong else 0)  # threads that compile cannot be called off


if __name__ == "__main__":
    main()
