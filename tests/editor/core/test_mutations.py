"""Levels from the worker that come while something else is under way."""

import threading

import pytest

from editor import actions
from editor.documents.commands.group import Remove
from editor.documents.document import Document
from editor.play.mode import Mode
from editor.worker.jobs import Worker
from kinetix.level.model import Circle, Level
from tests.editor.core.helpers import Hand, a_level, a_session, texts

SMALLER = a_level().replace(
    joints=(),
    thrusters=(),
    bodies=(*a_level().bodies[:2], a_level().body(3).replace(shape=Circle(radius=0.3))),
)


class Mutating:
    """A session for which a mutation is being made; `come` lets it arrive."""

    def __init__(self, result=SMALLER):
        self._made = threading.Event()
        self._result = result
        self.session = a_session()
        self.session.worker = Worker(perform=self._perform)
        self.hand = Hand(self.session)
        assert actions.run(self.session, "level.mutate")

    def _perform(self, request, progress):
        self._made.wait(10.0)
        return self._result

    def come(self):
        self._made.set()
        self.session.worker.wait(10.0)
        self.hand.wait()


@pytest.mark.parametrize(
    ("chosen", "at"), [(5, (2.2, 2.0)), (6, (1.85, 2.1)), (3, (4.2, 3.0)), (4, (1.0, 4.0))]
)
def test_a_mutation_waits_until_the_gesture_has_ended(chosen, at):
    mutating = Mutating()
    session, hand = mutating.session, mutating.hand
    session.selection = (chosen,)
    hand.press(at)
    hand.hold((at[0] + 0.05, at[1]))
    mutating.come()
    hand.hold((at[0] + 0.1, at[1]))
    assert session.driver.active and session.document.level == a_level()
    hand.release((at[0] + 0.1, at[1]))
    hand.wait()
    assert len(list(session.document.level.entities())) == 6
    assert session.document.level != a_level()
    assert texts(session) == ["Mutate: the level has changed meanwhile; try again."]


def test_a_mutation_comes_after_a_gesture_that_was_left():
    mutating = Mutating()
    mutating.session.selection = (3,)
    mutating.hand.press((4.0, 3.0))
    mutating.hand.hold((4.3, 3.0))
    mutating.come()
    mutating.hand.key("escape")
    mutating.hand.wait()
    assert mutating.session.document.level.bodies == SMALLER.bodies
    assert texts(mutating.session) == []


def test_a_joint_that_goes_away_while_it_is_dragged_is_told():
    session = a_session()
    hand = Hand(session)
    session.selection = (5,)
    hand.press((2.2, 2.0))
    hand.hold((2.25, 2.1))
    session.document.commit(Remove(ids=(5,)))
    hand.hold((2.3, 2.1))
    hand.release((2.3, 2.1))
    assert not session.driver.active and not session.document.previewing
    assert texts(session) == ["The joint that was dragged is gone."]


def test_a_mutation_reaches_its_level_behind_another_tab():
    mutating = Mutating()
    behind = mutating.session.document
    mutating.session.open_tab(Document(Level(name="Other")))
    mutating.come()
    assert behind.level.bodies == SMALLER.bodies
    assert mutating.session.document.level.name == "Other"
    assert texts(mutating.session) == ["Mutate: Test was changed."]


def test_a_mutation_comes_after_play():
    mutating = Mutating()
    session = mutating.session
    assert actions.run(session, "run.play_human")
    mutating.come()
    assert session.mode is Mode.PLAYING and texts(session) == []
    assert actions.run(session, "run.stop")
    mutating.hand.wait()
    assert session.document.level.bodies == SMALLER.bodies
    assert texts(session) == ["Mutate: Test was changed."]


def test_a_mutation_that_changes_nothing_says_so():
    mutating = Mutating(a_level())
    mutating.come()
    assert texts(mutating.session) == ["Mutate: nothing was changed; try again."]
    assert mutating.session.document.history.undo_label is None


def test_a_mutation_of_a_level_that_was_closed_is_let_go():
    mutating = Mutating()
    mutating.session.close_tab(mutating.session.tab)
    mutating.come()
    assert texts(mutating.session) == []
    assert mutating.session.document.level.bodies == ()
