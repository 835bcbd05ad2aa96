"""Files that would cost time or memory, or mean two things, are refused in a sentence."""

import io
import json
import os
import struct
import time
import zipfile

import numpy as np
import pytest

from kinetix.errors import KinetixError, plain
from kinetix.files.arrays import read_npz, read_tensors, tensor_shapes
from kinetix.files.json_text import parse_strictly, read_object
from kinetix.files.limits import DEPTH, LIMITS
from kinetix.files.regular import FileError, read_text

BAD_JSON = {
    "deep": ("[" * 100_000, "nested too deeply"),
    "deep and mixed": ('{"a": [' * 40 + "]}" * 40, "nested too deeply"),
    "twice": ('{"a": {"b": 1, "b": 2}}', r"\$\.a\.b: the key stands twice"),
    "nan": ('{"a": [1, NaN]}', r"\$\.a\[1\]: expected a finite number"),
    "overflow": ('{"a": 1e999}', r"\$\.a: expected a finite number"),
    "integer": ('{"a": 99999999999999999999}', r"\$\.a: expected a whole number of at most 64"),
    "digits": ("9" * 5000, "thousands of digits"),
    "surrogate": (r'{"a": ["\ud800"]}', r"\$\.a\[0\]: expected Unicode text"),
    "mark": ("\ufeff{}", "byte-order mark"),
    "cut": ('{"a": ', "not JSON, line 1 column 7"),
}


@pytest.mark.parametrize(("text", "says"), BAD_JSON.values(), ids=BAD_JSON)
def test_json_that_is_not_read(text, says):
    with pytest.raises(FileError, match=says):
        parse_strictly(text, "x.json")


def test_json_of_the_allowed_depth_is_read():
    assert parse_strictly("[" * DEPTH + "]" * DEPTH, "x") is not None
    assert parse_strictly('"' + "[" * 1000 + r"\"" + '"', "x").count("[") == 1000


@pytest.mark.parametrize("text", ['"' + r"\"" * 500_000, "[" * 999_999, "{" * 999_999, "]" * 10**6])
def test_hostile_text_costs_no_time(text):
    began = time.monotonic()
    with pytest.raises(FileError):
        parse_strictly(text, "x")
    assert time.monotonic() - began < 2


def test_only_regular_files_are_read(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "loop").symlink_to("loop")
    (tmp_path / "latin").write_bytes(b"\xe9")
    (tmp_path / "list").write_text("[]")
    for name, says in (
        ("pipe", "got a device, pipe or socket"),
        ("loop", "cannot be read"),
        (".", "got a folder"),
        ("none", "No such file"),
        ("a\0b", "cannot be read"),
        ("n" * 300, "cannot be read"),
        ("latin", "expected UTF-8 text, got byte 0 as 0xe9"),
    ):
        with pytest.raises(FileError, match=says):
            read_text(tmp_path / name, "level")
    with pytest.raises(FileError, match="got a device"):
        read_text(tmp_path.__class__("/dev/zero"), "level")
    with pytest.raises(FileError, match="expected an object, got list"):
        read_object(tmp_path / "list", "kept")


def test_large_files_are_refused_unread(tmp_path):
    with (tmp_path / "large").open("wb") as file:
        file.truncate(LIMITS["kept"].largest + 1)
    with pytest.raises(FileError, match="at most 64 MiB"):
        read_text(tmp_path / "large", "kept")


def _npy(shape, *, dtype="<f4", data=b"", version=1):
    header = f"{{'descr': {dtype!r}, 'fortran_order': False, 'shape': {shape!r}, }}\n".encode()
    return b"\x93NUMPY" + bytes([version, 0]) + struct.pack("<H", len(header)) + header + data


def _zip(**members):
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in members.items():
            archive.writestr(f"{name}.npy", data)
    return packed.getvalue()


def _flipped(data, at):
    return data[:at] + bytes([data[at] ^ 0xFF]) + data[at + 1 :]


_GOOD = _zip(a=_npy((4,), data=bytes(16)))
BAD_ARCHIVES = {
    "empty": (b"", "not a zip file"),
    "cut": (_GOOD[:-30], "not a zip file"),
    "flipped": (_flipped(_GOOD, 60), "."),
    "huge shape": (_zip(a=_npy((10**12,), data=bytes(16))), "cut off"),
    "overflow": (_zip(a=_npy((10**30, 10**30), data=bytes(16))), "cut off"),
    "negative": (_zip(a=_npy((-1,), data=bytes(16))), "negative"),
    "too long": (_zip(a=_npy((1,), data=bytes(16))), "another length"),
    "objects": (_zip(a=_npy((1,), dtype="|O", data=bytes(16))), "type object"),
    "version": (_zip(a=_npy((1,), version=9, data=bytes(4))), "unknown version"),
    "header": (_zip(a=b"\x93NUMPY\x01\x00\x04\x00((((" + bytes(4)), "."),
    "no array": (_zip(a=b"hello"), "."),
    "many": (_zip(**{f"a{k}": b"" for k in range(100)}), "at most 64 arrays"),
}


@pytest.mark.parametrize(("data", "says"), BAD_ARCHIVES.values(), ids=BAD_ARCHIVES)
def test_archives_that_are_not_read(tmp_path, data, says):
    path = tmp_path / "x.npz"
    path.write_bytes(data)
    with pytest.raises(FileError, match=says):
        read_npz(path, "trace")


def test_an_archive_that_unpacks_to_gigabytes_is_refused_unread(tmp_path):
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a.npy", bytes(LIMITS["trace"].largest + 1))
    (tmp_path / "bomb.npz").write_bytes(packed.getvalue())
    with pytest.raises(FileError, match="at most 256 MiB in all"):
        read_npz(tmp_path / "bomb.npz", "trace")


def test_archives_of_numpy_are_read(tmp_path):
    arrays = {
        "real": np.arange(6.0).reshape(2, 3),
        "column": np.asfortranarray(np.arange(6).reshape(2, 3)),
        "text": np.array("lamp"),
        "empty": np.zeros((0, 3), np.float32),
        "nothing": np.array(""),
        "flag": np.array(True),
    }
    np.savez_compressed(tmp_path / "x.npz", **arrays)
    found = read_npz(tmp_path / "x.npz", "trace")
    for name, array in arrays.items():
        np.testing.assert_array_equal(found[name], array)
        assert found[name].dtype == array.dtype


@pytest.mark.parametrize(
    "data", [b"", b"\xff" * 8, struct.pack("<Q", 2**40), struct.pack("<Q", 2) + b"[]"]
)
def test_tensors_that_are_not_read(tmp_path, data):
    (tmp_path / "x.safetensors").write_bytes(data)
    with pytest.raises(FileError, match="not a readable safetensors file"):
        tensor_shapes(tmp_path / "x.safetensors")


def test_tensors_are_read(tmp_path):
    from safetensors.numpy import save_file

    path = tmp_path / "x.safetensors"
    save_file({"a": np.ones((2, 3), np.float32), "b": np.ones(2, np.float64)}, path)
    assert tensor_shapes(path) == {"a": (2, 3), "b": (2,)}
    np.testing.assert_array_equal(read_tensors(path, {"a": ()})["a"], np.ones((2, 3)))
    with pytest.raises(FileError, match="tensor 'b' is float64"):
        read_tensors(path, {"b": ()})


def test_sentences_are_one_plain_line_of_bounded_length():
    sentence = str(KinetixError(f"\x1b]0;owned\x07{json.dumps('x' * 6000)}\nsecond \u202e\x9b2J"))
    assert len(sentence) < 1100
    assert sentence.isprintable()
    assert sentence.startswith("\\u001b]0;owned")
    assert sentence.endswith("\\u009b2J")
    assert plain("Lampe ü ↑ 灯") == "Lampe ü ↑ 灯"
