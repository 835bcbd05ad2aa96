"""Caches on disk have bounds, and a command that clears them."""

import os
from pathlib import Path

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


def test_clearing_leaves_the_folder_to_programs_that_run(cache, tmp_path_factory):
    folder = caches.cache_folder("jax")
    elsewhere = tmp_path_factory.mktemp("elsewhere") / "jax"
    folder.rename(elsewhere)
    folder.symlink_to(elsewhere)
    kept = elsewhere.parent / "kept"
    kept.mkdir()
    (kept / "mine").write_text("mine")
    (elsewhere / "link").symlink_to(kept)
    assert caches.clear_cache("jax") >= 4000
    assert folder.is_symlink() and list(elsewhere.iterdir()) == []
    assert (kept / "mine").exists()
    caches.clear_cache("steps")
    assert list(caches.cache_folder("steps").iterdir()) == []


def test_what_could_not_be_deleted_is_said(cache, monkeypatch, capsys):
    def refuse(*_, **__):
        raise PermissionError

    monkeypatch.setattr(Path, "unlink", refuse)
    assert main(["cache", "--clear"]) == 1
    assert "could not be deleted" in capsys.readouterr().err


def test_folders_that_go_meanwhile_do_not_hurt(cache, monkeypatch):
    folder = caches.cache_folder("gallery")
    real = os.scandir

    def slow(path):
        if os.fspath(path) == os.fspath(folder / "below"):
            raise FileNotFoundError
        return real(path)

    monkeypatch.setattr(os, "scandir", slow)
    caches.tidy_caches()
    assert caches.cache_bytes("gallery") == 0
