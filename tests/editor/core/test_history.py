import pytest

from editor.documents.history import ENTRIES_MAX, Entry, History


def entry(value, key=None, time=0.0):
    return Entry(label=f"to {value}", value=value, selection=(), merge_key=key, time=time)


def test_undo_and_redo_walk_the_snapshots():
    history = History(0, ())
    for value in (1, 2, 3):
        history.push(entry(value))
    assert history.undo().value == 2
    assert history.undo().value == 1
    assert (history.undo_label, history.redo_label) == ("to 1", "to 2")
    assert history.redo().value == 2


def test_the_ends_are_quiet():
    history = History(0, ())
    assert history.undo() is None
    assert history.redo() is None
    assert history.undo_label is None


def test_a_new_entry_drops_what_could_be_redone():
    history = History(0, ())
    history.push(entry(1))
    history.push(entry(2))
    history.undo()
    history.push(entry(9))
    assert [e.value for e in history.entries] == [0, 1, 9]
    assert history.redo() is None


def test_equal_keys_merge_while_they_follow_quickly():
    history = History(0, ())
    history.push(entry(1, "nudge", 1.0))
    history.push(entry(2, "nudge", 1.4))
    history.push(entry(3, "nudge", 1.8))
    assert [e.value for e in history.entries] == [0, 3]
    history.push(entry(4, "nudge", 2.4))
    history.push(entry(5, "other", 2.5))
    assert [e.value for e in history.entries] == [0, 3, 4, 5]


def test_no_entry_merges_into_one_that_was_reached_by_undo():
    history = History(0, ())
    history.push(entry(1, "nudge", 1.0))
    history.push(entry(2, None, 1.1))
    history.undo()
    history.push(entry(3, "nudge", 1.2))
    assert [e.value for e in history.entries] == [0, 1, 3]


def test_selecting_keeps_what_can_be_redone():
    history = History(0, ())
    history.push(entry(1))
    history.undo()
    history.select((7,))
    assert history.redo_label == "to 1"
    assert history.current.selection == (7,)


def test_only_so_many_are_kept():
    history = History(-1, ())
    for value in range(ENTRIES_MAX + 50):
        history.push(entry(value))
    assert len(history.entries) == ENTRIES_MAX >= 500
    assert history.current.value == ENTRIES_MAX + 49


def test_jumping_outside_is_refused():
    with pytest.raises(IndexError, match="no history entry 3"):
        History(0, ()).jump(3)
