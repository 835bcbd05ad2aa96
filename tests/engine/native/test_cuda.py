"""The compiler for GPUs: what it makes is kept, and what stands in its way is told."""

import importlib.util
import os
import sys

import pytest

from kinetix.engine.native import cuda

PROGRAM = b"//\n.version 9.5\n.target sm_90\n.version in a comment"


@pytest.mark.parametrize(
    ("code", "target", "first"),
    [
        (PROGRAM, "sm_90", b".version 8.3"),
        (PROGRAM, "sm_75", b".version 8.3"),
        (PROGRAM, "sm_90a", b".version 8.3"),
        (PROGRAM, "sm_100", b".version 9.5"),
        (PROGRAM.replace(b"9.5", b"8.1"), "sm_90", b".version 8.1"),
        (b"", "sm_90", b""),
    ],
)
def test_assembly_claims_no_newer_version_than_it_needs(code, target, first):
    found = cuda.for_older_drivers(code, target)
    assert first in found
    assert found.count(b".version") == code.count(b".version")


def test_what_was_compiled_is_kept(tmp_path, monkeypatch):
    made = []

    def compiles(source, target):
        made.append(source)
        return source.encode() + target.encode()

    monkeypatch.setattr("kinetix.files.caches.cache_dir", lambda: tmp_path)
    monkeypatch.setattr(cuda, "_compiled", compiles)
    for source, target in (("a", "sm_90"), ("a", "sm_90"), ("b", "sm_90"), ("a", "sm_80")):
        assert cuda.compiled(source, target) == source + target
    assert made == ["a", "b", "a"]
    assert len(list((tmp_path / "kernels").iterdir())) == 3


def test_a_cache_that_cannot_be_written_to_is_none(tmp_path, monkeypatch):
    (tmp_path / "kernels").write_text("a file")
    monkeypatch.setattr("kinetix.files.caches.cache_dir", lambda: tmp_path)
    monkeypatch.setattr(cuda, "_compiled", lambda source, target: b"code")
    assert cuda.compiled("a", "sm_90") == "code"


def test_what_was_kept_is_used_where_it_can_only_be_read(tmp_path, monkeypatch):
    def refuse(*_):
        raise PermissionError

    monkeypatch.setattr("kinetix.files.caches.cache_dir", lambda: tmp_path)
    monkeypatch.setattr(cuda, "_compiled", lambda source, target: b"code")
    cuda.compiled("a", "sm_90")
    monkeypatch.setattr(cuda, "_compiled", lambda source, target: b"compiled again")
    monkeypatch.setattr(os, "utime", refuse)
    assert cuda.compiled("a", "sm_90") == "code"


def test_a_missing_compiler_is_told_with_how_to_install_it(tmp_path, monkeypatch):
    monkeypatch.setattr("kinetix.files.caches.cache_dir", lambda: tmp_path)
    monkeypatch.setitem(sys.modules, "cuda", None)
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(cuda.CannotCompile, match=r"pip install .*cuda12"):
        cuda.compiled("a", "sm_90")


def test_without_a_gpu_there_is_no_architecture():
    assert cuda.architecture() is None
