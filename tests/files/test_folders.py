"""Folders that commands begin to write into."""

import os

import pytest

from kinetix.errors import KinetixError
from kinetix.files.folders import begun_folder
from kinetix.files.lock import fcntl, locked_folder


def test_a_new_folder_stays_where_something_is_in_it(tmp_path):
    for name in ("empty", "filled"):
        with begun_folder(tmp_path / name, "another"):
            if name == "filled":
                (tmp_path / name / "x").write_text("x")
    assert os.listdir(tmp_path) == ["filled"]


@pytest.mark.skipif(fcntl is None, reason="needs locks")
def test_who_is_refused_does_not_remove_the_folder(tmp_path, monkeypatch):
    folder = tmp_path / "out"
    with begun_folder(folder, "another"):
        with monkeypatch.context() as patch:
            # As seen by a process that looked before the folder was made.
            patch.setattr(os.path, "isdir", lambda path: False)
            with pytest.raises(KinetixError, match="another writes here now"):
                begun_folder(folder, "another").__enter__()
        (folder / "x").write_text("x")


@pytest.mark.skipif(fcntl is None, reason="needs locks")
def test_a_folder_that_was_removed_before_it_was_locked_is_told(tmp_path, monkeypatch):
    folder = tmp_path / "out"
    with pytest.raises(KinetixError, match="cannot be locked"):
        locked_folder(folder, "another").__enter__()
    folder.mkdir()
    monkeypatch.setattr(fcntl, "flock", lambda *_: folder.rmdir())
    with pytest.raises(KinetixError, match="has removed this folder"):
        locked_folder(folder, "another").__enter__()
