"""The set that is put together outlives the app, and two windows lose nothing of it."""

import json

import pytest

from editor.gallery.kept_set import WEIGHTS, KeptSet
from kinetix.errors import LevelError


@pytest.fixture
def path(tmp_path):
    return tmp_path / "state" / "set.json"


def test_a_set_is_there_again_with_its_weights_and_in_its_order(path):
    KeptSet(path).keep({"/b.json": 2.5, "/a.json": 1.0})
    assert list(KeptSet(path).read().items()) == [("/b.json", 2.5), ("/a.json", 1.0)]
    assert KeptSet(path, stored=False).read() == {}


def test_an_emptied_set_is_empty_the_next_time(path):
    kept = KeptSet(path)
    kept.keep({"/a.json": 1.0})
    kept.keep({})
    assert KeptSet(path).read() == {}


def test_what_two_windows_put_together_stays(path):
    first, second = KeptSet(path), KeptSet(path)
    assert first.read() == second.read() == {}
    first.keep({"/a.json": 2.0})
    second.keep({"/b.json": 3.0})
    assert KeptSet(path).read() == {"/a.json": 2.0, "/b.json": 3.0}
    second.keep({})
    assert KeptSet(path).read() == {"/a.json": 2.0}


def test_what_is_broken_in_the_file_is_passed_over_and_stays_as_a_backup(path):
    path.parent.mkdir()
    low, high = WEIGHTS
    path.write_text(json.dumps({"levels": {"/a": 1e9, "/b": "x", "/c": 0, "/d": 2}}))
    assert KeptSet(path).read() == {"/a": high, "/c": low, "/d": 2.0}
    path.write_text("{")
    kept = KeptSet(path)
    assert kept.read() == {}
    kept.keep({"/a": 1.0})
    assert KeptSet(path).read() == {"/a": 1.0}
    assert path.with_name("set.json.bak").read_text() == "{"


def test_what_cannot_be_written_is_tried_again_at_the_end(path, monkeypatch):
    def full(path, tree):
        raise LevelError(f"{path}: cannot be saved: No space left on device")

    kept = KeptSet(path)
    with monkeypatch.context() as context:
        context.setattr("editor.gallery.kept_set.write_state", full)
        with pytest.raises(LevelError):
            kept.keep({"/a": 1.0})
        kept.keep({"/a": 1.0})
    kept.keep({"/a": 1.0}, again=True)
    assert KeptSet(path).read() == {"/a": 1.0}
