"""Promises of the core as a whole: no JAX, no toolkit, and fast enough."""

import subprocess
import sys

from editor import actions
from editor.documents.commands.group import Move
from editor.documents.document import Document
from editor.editing.snapping import snap_shift, targets
from kinetix.level.model import Body, Circle, Level
from tests.editor.core.helpers import SQUARE, Hand, a_level, a_session
from tests.pace import share_of

WITHOUT_JAX = """
import sys

BLOCKED = ("jax", "jaxlib", "flax", "pygame", "imgui_bundle", "OpenGL")


class Block:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in BLOCKED:
            raise ImportError(f"{name} is blocked")


sys.meta_path.insert(0, Block())
from tests.editor.core.helpers import Hand, a_session

session = a_session()
hand = Hand(session)
hand.key("c")
hand.drag((2.0, 3.0), (2.3, 3.0))
hand.key("a", ctrl=True)
hand.key("d", ctrl=True)
hand.key("z", ctrl=True)
hand.wait()
hand.key("s", ctrl=True)
from pathlib import Path
session.answer(session.prompts[-1], Path(sys.argv[1]))
hand.key("q", ctrl=True)
assert session.quitting
assert not any(name in sys.modules for name in BLOCKED)
print(session.document.hash)
"""


def test_editing_saving_and_quitting_need_neither_jax_nor_a_toolkit(tmp_path):
    run = subprocess.run(
        [sys.executable, "-c", WITHOUT_JAX, str(tmp_path / "made.json")],
        capture_output=True,
        text=True,
        check=False,
        env={"PATH": "", "HOME": str(tmp_path), "PYTHONPATH": ":".join(p for p in sys.path if p)},
    )
    assert run.returncode == 0, run.stderr
    from kinetix.level.codec import level_hash, load_level

    assert run.stdout.strip() == level_hash(load_level(tmp_path / "made.json"))


def fifty():
    bodies = tuple(
        Body(
            id=k + 1,
            shape=SQUARE if k % 2 else Circle(radius=0.15),
            position=(0.4 + 0.6 * (k % 8), 0.7 + 0.6 * (k // 8)),
            angle=0.1 * k,
        )
        for k in range(50)
    )
    return Level(name="fifty", bodies=bodies)


def test_a_dragged_body_snaps_fast():
    level = fifty()
    rules = a_session(level, snap_smart=True, snap_grid=True).rules()
    available = targets(level, {1})

    def snap():
        snap_shift(level.bodies[:1], (0.33, 0.21), rules, available)

    assert share_of(1e-3, snap) <= 1


def test_a_frame_of_a_drag_is_fast():
    session = a_session(fifty(), snap_smart=True)
    hand = Hand(session)
    hand.press((0.4, 0.7))
    hand.hold((0.6, 0.8))
    steps = iter(range(100))
    assert share_of(8e-3, lambda: hand.hold((0.6 + 0.01 * next(steps), 0.8))) <= 1


def test_undo_and_the_live_problems_are_fast():
    document = Document(fifty())
    document.commit(Move(ids=(1,), shift=(0.1, 0.0)))

    def there_and_back():
        document.undo()
        document.redo()

    assert share_of(10e-3, there_and_back) <= 1

    def problems():
        document.preview(Move(ids=(1,), shift=(0.01, 0.0)))
        return document.problems

    assert share_of(20e-3, problems) <= 1


def test_a_recording_of_events_gives_the_same_document_again():
    def record():
        session = a_session(a_level(), snap_smart=True, snap_grid=True)
        hand = Hand(session)
        hand.key("c")
        hand.drag((3.0, 1.0), (3.31, 1.02))
        hand.drag((4.0, 3.0), (3.13, 2.2))
        actions.run(session, "edit.duplicate")
        hand.key("q")
        return session.document.hash

    assert record() == record()
