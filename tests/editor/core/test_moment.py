"""A paused episode is changed, and played on, kept as the level's start, or dropped."""

import pytest

from editor.actions import run, update
from editor.actions.files import file
from editor.base.prompts import Question
from editor.documents.commands.bodies import posed
from editor.documents.commands.fields import SetField
from editor.documents.commands.group import Move, Remove
from editor.documents.document import Document
from editor.play.mode import Mode
from kinetix.level.codec import load_level, save_level
from tests.editor.core.helpers import a_level, pause_episode, texts


@pytest.fixture
def paused(session, hand):
    """A session whose episode stands at some step."""
    pause_episode(session, hand)
    assert session.playback.step_count > 3
    return session


def test_a_paused_episode_becomes_a_level_with_tools_and_undo(paused, hand):
    step, before = paused.playback.step_count, paused.tab.document.level
    shown = posed(before, paused.playback.snapshot)
    assert run(paused, "run.change")
    assert paused.mode is Mode.EDIT
    assert paused.document.level.bodies == shown.bodies
    hand.drag((4.0, shown.body(3).position[1]), (3.0, 2.0))
    moved = paused.document.level.body(3).position
    assert moved != shown.body(3).position
    assert run(paused, "edit.undo")
    assert paused.document.level.body(3).position == shown.body(3).position
    assert run(paused, "edit.redo")
    assert run(paused, "run.play_human")
    hand.wait()
    assert paused.mode is Mode.PLAYING
    assert paused.playback.level.body(3).position == moved
    assert paused.playback.step_count >= step  # it goes on, it does not begin again
    assert paused.playback.perturbed
    assert paused.tab.document.level == before


def test_what_was_deleted_stays_away_while_the_changed_level_compiles(paused, hand):
    assert run(paused, "run.change")
    paused.execute(Remove(ids=(1,)))
    changed = paused.document.level
    paused.playback.simulator.delayed = True
    assert run(paused, "run.play_human")
    hand.wait()
    assert paused.playback.waiting
    assert paused.scene.bodies == changed.bodies


def test_nothing_changed_goes_on_with_the_same_episode(paused, hand):
    episode, step = paused.playback.episode, paused.playback.step_count
    assert run(paused, "run.change")
    assert run(paused, "run.play_human")
    assert paused.tab.moment is None
    assert (paused.playback.episode, paused.playback.perturbed) == (episode, False)
    for _ in range(10):
        hand.wait()
    assert paused.playback.step_count > step


def test_keeping_it_is_one_edit_of_the_level(paused):
    before = paused.tab.document.level
    assert run(paused, "run.change")
    paused.execute(SetField(ids=(1,), field="density", value=3.0))
    paused.execute(Remove(ids=(4,)))
    assert run(paused, "run.keep_moment")
    document = paused.document
    assert document is paused.tab.document
    assert (paused.mode, paused.tab.moment) == (Mode.EDIT, None)
    assert document.level.body(1).density == 3.0
    assert document.level.body(1).position != before.body(1).position
    assert [body.id for body in document.level.bodies] == [1, 2, 3]
    assert document.level.name == before.name
    assert document.history.undo_label.startswith("Start from step ")
    assert run(paused, "edit.undo")
    assert document.level == before
    assert not document.dirty


def test_dropping_it_brings_back_the_episode(paused, hand):
    step, before = paused.playback.step_count, paused.tab.document.level
    episode = paused.playback.episode
    assert run(paused, "run.change")
    paused.execute(Move(ids=(1,), shift=(0.3, 0.0)))
    assert run(paused, "run.drop_moment")
    assert (paused.mode, paused.playback.step_count) == (Mode.PAUSED, step)
    assert paused.playback.episode == episode
    assert any("were dropped" in words for words in texts(paused))
    run(paused, "run.pause")
    for _ in range(10):
        hand.wait()
    assert paused.playback.step_count > step
    run(paused, "run.stop")
    assert paused.document.level == before


def test_stopping_what_was_played_on_leads_back_to_what_was_changed(paused, hand):
    assert run(paused, "run.change")
    paused.execute(Move(ids=(1,), shift=(0.3, 0.0)))
    changed = paused.document.level
    run(paused, "run.play_human")
    hand.wait()
    run(paused, "run.stop")
    assert paused.mode is Mode.EDIT
    assert paused.document.level == changed  # nothing of it is lost
    assert run(paused, "run.drop_moment")
    assert paused.mode is Mode.EDIT
    assert paused.document is paused.tab.document


def test_a_reset_begins_where_it_was_changed(paused, hand):
    assert run(paused, "run.change")
    at = paused.tab.moment.snapshot.step
    paused.execute(Move(ids=(1,), shift=(0.3, 0.0)))
    run(paused, "run.play_human")
    for _ in range(10):
        hand.wait()
    run(paused, "run.reset")
    hand.wait()
    assert paused.playback.step_count in (at, at + 1)
    assert paused.playback.perturbed


def test_it_can_be_changed_again_and_all_of_it_undone(paused, hand):
    run(paused, "run.change")
    paused.execute(Move(ids=(1,), shift=(0.3, 0.0)))
    first = paused.document.level
    run(paused, "run.play_human")
    for _ in range(10):
        hand.wait()
    run(paused, "run.pause")
    hand.wait()
    assert run(paused, "run.change")
    assert paused.document.level != first
    run(paused, "edit.undo")
    assert paused.document.level == first


def test_only_a_paused_episode_can_be_changed(session, hand):
    assert not run(session, "run.change")
    run(session, "run.play_human")
    hand.wait()
    assert not run(session, "run.change")
    session.playback.simulator.ends_at = 5
    for _ in range(30):
        hand.wait()
    assert session.mode is Mode.ENDED
    assert not run(session, "run.change")
    assert not run(session, "run.keep_moment")
    assert not run(session, "run.drop_moment")


def test_a_moment_is_never_saved_over_the_level(paused, tmp_path):
    path = tmp_path / "cart.json"
    save_level(a_level(), path)
    paused.tab.document.mark_saved(path)
    run(paused, "run.change")
    paused.execute(Move(ids=(1,), shift=(0.3, 0.0)))
    run(paused, "file.save")
    assert load_level(path) == a_level()
    assert any("keep it as the level's start" in words for words in texts(paused))


@pytest.mark.parametrize("way", ["file.close_tab", "file.quit"])
@pytest.mark.parametrize("choice", ["keep", "drop", "cancel"])
def test_leaving_asks_what_shall_become_of_it(paused, way, choice):
    before = paused.tab.document.level
    run(paused, "run.change")
    paused.execute(Move(ids=(1,), shift=(0.3, 0.0)))
    run(paused, way)
    question = paused.prompts[-1]
    assert isinstance(question, Question)
    assert question.title == "A paused episode was changed"
    tab = paused.tab
    paused.answer(question, choice)
    if choice == "cancel":
        assert tab.moment is not None
        assert not paused.prompts
    elif choice == "drop":
        assert tab.document.level == before
        assert paused.quitting or tab not in paused.tabs
    else:
        assert tab.document.dirty
        assert paused.prompts[-1].title == "Unsaved changes"


@pytest.mark.parametrize("way", ["file.close_tab", "file.quit"])
@pytest.mark.parametrize("choice", ["save", "discard", "cancel"])
def test_only_who_leaves_loses_the_paused_episode(paused, way, choice):
    run(paused, "run.stop")
    paused.execute(Move(ids=(1,), shift=(0.3, 0.0)))
    run(paused, "run.play_human")
    update(paused, 0.1)
    run(paused, "run.pause")
    update(paused, 0.1)
    assert run(paused, "run.change")
    run(paused, way)
    assert paused.prompts[-1].title == "Unsaved changes"
    moment = paused.tab.moment
    paused.answer(paused.prompts[-1], choice)
    assert paused.tab.moment is (moment if choice == "cancel" else None)
    assert paused.playback.suspended == (choice == "cancel")


def test_who_drops_the_changes_and_stays_is_back_in_the_level(paused):
    paused.tab.document.mark_unsaved()
    run(paused, "run.change")
    paused.execute(Move(ids=(1,), shift=(0.3, 0.0)))
    run(paused, "file.quit")
    for choice in ("drop", "cancel"):
        paused.answer(paused.prompts[-1], choice)
    assert not paused.playback.suspended and paused.document is paused.tab.document


def test_all_is_saved_also_where_an_episode_stands_still(paused, tmp_path):
    other = Document(a_level(), path=tmp_path / "other.json")
    other.mark_unsaved()
    paused.tab.document.mark_saved(tmp_path / "mine.json")
    paused.tab.document.mark_unsaved()
    run(paused, "run.change")
    paused.tabs.open(other)
    paused.show_tab(0)
    run(paused, "file.quit")
    paused.answer(paused.prompts[-1], "save")
    assert paused.quitting, texts(paused)
    assert load_level(tmp_path / "mine.json") == load_level(tmp_path / "other.json") == a_level()


def test_a_file_that_is_opened_takes_no_tab_with_changes(paused, tmp_path):
    path = tmp_path / "other.json"
    save_level(a_level(), path)
    run(paused, "run.change")
    paused.execute(Move(ids=(1,), shift=(0.3, 0.0)))
    moment = paused.tab.moment
    assert file.open_path(paused, path, replace=True)
    assert len(paused.tabs) == 2
    paused.show_tab(0)
    assert paused.tab.moment is moment


def test_what_is_locked_or_hidden_stays_so_in_a_paused_episode(paused, hand):
    paused.document.locked, paused.document.hidden = frozenset({1}), frozenset({3})
    run(paused, "run.change")
    assert (paused.document.locked, paused.document.hidden) == ({1}, {3})
    before = paused.document.level
    paused.selection = (1, 2)
    hand.key("delete")
    assert [body.id for body in paused.document.level.bodies] == [1, 3, 4]
    assert before.body(1) == paused.document.level.body(1)
