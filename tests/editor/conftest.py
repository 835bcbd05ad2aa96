"""Fixtures of all editor tests: the state that an earlier run of the app has left."""

from pathlib import Path

import pytest

from editor.worker.jobs import Worker
from tests.editor import days


@pytest.fixture(scope="session")
def yesterday(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the user's folders after a day with the app."""
    home = tmp_path_factory.mktemp("yesterday")
    worker = Worker(perform=days.refuse)
    days.live_through(home, worker)
    worker.stop()
    return home
