"""A cut entry of JAX's cache is told in one sentence and replaced."""

import subprocess
import sys
import warnings

import pytest

from kinetix.files import compiled
from kinetix.files.compiled import mended_programs

_CUTTING = """
import jax
from kinetix.files.caches import cache_folder
from kinetix.files.compiled import mended_programs

folder = cache_folder("jax")
folder.mkdir(parents=True)
jax.config.update("jax_compilation_cache_dir", str(folder))
jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.0)

@jax.jit
def doubled(x):
    return 2 * x

with mended_programs():
    for _ in range(3):
        doubled(jax.numpy.ones(3))
        jax.clear_caches()
        for path in folder.glob("jit_doubled-*"):
            print(path.stat().st_size)
            path.write_bytes(path.read_bytes()[:100])
"""


def test_a_cut_program_is_told_once_and_written_anew(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    done = subprocess.run(
        [sys.executable, "-c", _CUTTING], capture_output=True, text=True, check=True
    )
    whole, *again = map(int, done.stdout.split())
    assert whole > 100 and len(again) == 2 and min(again) > 100
    (said,) = done.stderr.splitlines()
    assert said.startswith(f"{tmp_path}") and "`kinetix cache --clear`" in said


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr(compiled, "_is_used", lambda _: True)
    monkeypatch.setattr(compiled, "cache_folder", lambda _: tmp_path)
    for name in ("jit_f-1", "jit_f-2", "jit_g-3"):
        (tmp_path / f"{name}-cache").write_bytes(compiled.zlib.compress(b"whole"))
    return tmp_path


def _warn(did, why):
    with mended_programs():
        warnings.warn(
            f"Error {did} persistent compilation cache entry for 'jit_f': {why}", stacklevel=1
        )


def _names(folder):
    return sorted(path.name[:-6] for path in folder.iterdir())


def test_only_what_is_cut_goes_if_something_is(folder, capsys):
    (folder / "jit_f-1-cache").write_bytes(b"")
    _warn("writing", "OSError: File too large")
    assert _names(folder) == ["jit_f-2", "jit_g-3"]
    assert "(OSError: File too large)" in capsys.readouterr().err
    _warn("writing", "OSError: File too large")
    assert _names(folder) == ["jit_f-2", "jit_g-3"]


def test_all_of_the_program_go_where_each_looks_whole(folder):
    _warn("reading", "ValueError: unknown format")
    assert _names(folder) == ["jit_g-3"]


def test_other_warnings_are_not_touched(folder):
    with pytest.warns(UserWarning, match="something else"), mended_programs():
        warnings.warn("something else", stacklevel=1)
    assert len(_names(folder)) == 3
