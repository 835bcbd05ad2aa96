"""Caches on disk have bounds, and a command that clears them."""

import os

import pytest

from kinetix.cli import main
from kinetix.files import caches


@pytest.fixture
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    for name in caches.CACHES:
        for k in range(4):
            path = caches.cache_folder(name) / "below" / f"{k}.bin"
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(bytes(1000))
            os.utime(path, (1000 + k, 1000 + k))
    return tmp_path


def test_the_files_that_were_used_longest_ago_go_first(cache, monkeypatch):
    folder = caches.cache_folder("gallery")
    caches.bound(folder, 2500)
    assert sorted(path.name for path in (folder / "below").iterdir()) == ["2.bin", "3.bin"]
    (folder / "young").write_bytes(bytes(5000))
    caches.bound(folder, 10)
    assert [path.name for path in folder.rglob("*") if path.is_file()] == ["young"]


def test_the_command_tells_and_clears(cache, capsys):
    assert main(["cache"]) == 0
    assert "compiled programs of JAX" in capsys.readouterr().out
    assert main(["cache", "--clear"]) == 0
    assert [caches.cache_bytes(name) for name in caches.CACHES] == [0] * len(caches.CACHES)
    assert main(["cache"]) == 0
