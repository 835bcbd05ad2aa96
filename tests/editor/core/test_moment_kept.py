"""Changes to a paused episode are copied like any other unsaved work."""

import pytest

from editor.actions import run, update
from editor.documents import recovery
from editor.documents.commands.group import Move
from editor.documents.commands.level import KeepSolution
from kinetix.level.model import Solution
from tests.editor.core.helpers import pause_episode, texts

MOVE = Move(ids=(3,), shift=(0.3, 0.0))


@pytest.fixture
def changed(session, hand):
    """A session whose paused episode was changed."""
    pause_episode(session, hand)
    assert run(session, "run.change")
    session.execute(MOVE)
    yield session
    session.autosaves.end()


def copies(session):
    session.autosaves.flush()
    return [recovery._read(file) for file in session.autosaves.folder.glob("*[0-9].json")]


def test_edits_of_a_paused_episode_are_copied(changed):
    for _ in range(20):
        update(changed, 0.25)
    (copy,) = copies(changed)
    assert copy.level.bodies == changed.document.level.bodies
    assert (copy.path, copy.level.name) == (None, "Test")


def test_a_fault_that_ends_the_app_leaves_a_copy_of_them(changed):
    changed.save_aside()
    assert [copy.level.bodies for copy in copies(changed)] == [changed.document.level.bodies]


@pytest.mark.parametrize("way", ["drop", "keep", "quit"])
def test_the_copy_goes_with_the_moment(changed, way):
    changed.save_aside()
    if way == "quit":
        run(changed, "file.quit")
        changed.answer(changed.prompts[-1], "drop")
        assert changed.quitting
    else:
        assert run(changed, "run.drop_moment" if way == "drop" else "run.keep_moment")
        update(changed, 0.1)
    kept = [changed.tab.document.level.bodies] if way == "keep" else []
    assert [copy.level.bodies for copy in copies(changed)] == kept


def test_a_start_that_is_kept_says_that_the_solution_is_dropped(changed):
    document = changed.tab.document
    solution = Solution(physics="kinetix-v2", frame_skip=1, actions=((5, (0, 0, 0, 0, 0, 0)),))
    document.commit(KeepSolution(solution=solution))
    assert run(changed, "run.keep_moment")
    assert document.level.solution is None
    assert "The recorded solution was dropped: the level changed." in texts(changed)
