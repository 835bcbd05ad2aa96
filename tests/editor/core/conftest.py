"""Every test of the core has a folder of its own for the user's files."""

import types

import pytest

from kinetix.level.codec import save_level
from tests.editor.core.helpers import Hand, a_level, a_session


@pytest.fixture(autouse=True)
def own_folders(tmp_path, monkeypatch):
    monkeypatch.setattr("editor.documents.autosaves.state_dir", lambda: tmp_path / "state")
    monkeypatch.setattr("kinetix.failures.state_dir", lambda: tmp_path / "state")
    monkeypatch.setattr("editor.base.settings.config_dir", lambda: tmp_path / "config")
    monkeypatch.setattr("editor.base.state_file.state_dir", lambda: tmp_path / "state")
    monkeypatch.setattr("editor.gallery.library.cache_dir", lambda: tmp_path / "cache")
    monkeypatch.setattr("editor.gallery.filing.user_levels_dir", lambda: tmp_path / "mine")
    monkeypatch.setattr("editor.actions.gallery.gallery.user_levels_dir", lambda: tmp_path / "mine")
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))


@pytest.fixture(autouse=True)
def no_training(monkeypatch):
    """No test trains for real by trying an action: the process ends as soon as it is begun."""
    ended = types.SimpleNamespace(poll=lambda: 0, send_signal=lambda sig: None)
    monkeypatch.setattr("editor.agents.local_training.start_process", lambda words, log: ended)


@pytest.fixture
def path(tmp_path):
    """The file of a level of the user's."""
    path = tmp_path / "mine.json"
    save_level(a_level(), path)
    return path


@pytest.fixture
def session():
    return a_session()


@pytest.fixture
def hand(session):
    return Hand(session)
