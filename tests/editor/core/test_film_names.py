"""Films of two windows that were given the same name before either was written."""

from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

import pytest

from editor.worker.requests import ExportFilm
from editor.worker.simulation import pictures
from kinetix.errors import KinetixError
from tests.editor.core.helpers import a_level


@pytest.fixture
def wanted(tmp_path, monkeypatch):
    """Two films for one file; each begins while the other one is being written."""
    monkeypatch.setattr(pictures, "_about", lambda request: "")
    monkeypatch.setattr(pictures, "steps_per_second", lambda request: 30.0)
    path = tmp_path / "mine-001.gif"
    traces = (SimpleNamespace(snapshots=()), SimpleNamespace(snapshots=()))
    films = [ExportFilm(level=a_level(), trace=t, path=path, numbered=True) for t in traces]
    return path, films


def test_each_is_kept(wanted, monkeypatch):
    path, (one, other) = wanted

    def write(file, frames, **_):
        if not list(path.parent.glob("*-002.gif")):  # the first one is still at work
            with ThreadPoolExecutor() as window:
                made.append(window.submit(pictures.export_film, other, None).result())
        file.write_text(f"film {len(made)}")

    made = []
    monkeypatch.setattr(pictures, "write_film", write)
    made.append(pictures.export_film(one, None))
    assert [each.name for each in made] == ["mine-002.gif", "mine-001.gif"]
    assert sorted(each.name for each in path.parent.glob("*.gif")) == [
        "mine-001.gif",
        "mine-002.gif",
    ]
    assert {each.read_text() for each in made} == {"film 0", "film 1"}


def test_one_that_fails_leaves_no_empty_file(wanted, monkeypatch):
    path, (one, _) = wanted

    def fail(*_, **__):
        raise KinetixError("the physics broke")

    monkeypatch.setattr(pictures, "write_film", fail)
    with pytest.raises(KinetixError):
        pictures.export_film(one, None)
    assert list(path.parent.glob("*.gif")) == []
