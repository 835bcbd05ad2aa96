"""Bounded reading of arrays: NumPy archives and safetensors. Nothing in them can execute."""

import zipfile
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from typing import Any, BinaryIO, Final

import numpy as np

from kinetix.files.limits import LIMITS, MEMBERS, MIB, Kind
from kinetix.files.regular import FileError, open_regular

_PLAIN_KINDS: Final = "biufU"
"""Booleans, integers, reals and text; no objects, no records."""
_HEADERS: Final = {
    (1, 0): np.lib.format.read_array_header_1_0,
    (2, 0): np.lib.format.read_array_header_2_0,
}
_LONGEST_HEADER: Final = 10_000


def read_npz(
    path: Path, kind: Kind, *, only: Collection[str] | None = None
) -> dict[str, np.ndarray]:
    """Read the arrays of a NumPy archive.

    Sizes are taken from the archive's directory and from each array's header, and compared with
    the limit and with each other before anything is unpacked.

    Args:
        path: The file.
        kind: Whose limit holds, for the file and for all its arrays together.
        only: Names of the arrays that are wanted; None: all.

    Raises:
        FileError: The file cannot be read, is not such an archive, is damaged, or holds too much.
    """
    with open_regular(path, kind) as file:
        # zipfile, zlib and NumPy raise whatever a damaged archive leads them to; here it is all
        # the same.
        try:
            return dict(_members(path, file, LIMITS[kind].largest, only))
        except FileError:
            raise
        except Exception as error:
            reason = str(error).strip() or type(error).__name__
            raise FileError(path, f"not a readable archive of arrays: {reason}") from None


def _members(
    path: Path, file: BinaryIO, largest: int, only: Collection[str] | None
) -> Iterator[tuple[str, np.ndarray]]:
    with zipfile.ZipFile(file) as archive:
        entries = archive.infolist()
        if len(entries) > MEMBERS:
            raise FileError(path, f"expected at most {MEMBERS} arrays, got {len(entries)}")
        if sum(entry.file_size for entry in entries) > largest:
            raise FileError(path, f"expected arrays of at most {largest // MIB} MiB in all")
        for entry in entries:
            name = entry.filename.removesuffix(".npy")
            if only is not None and name not in only:
                continue
            with archive.open(entry) as member:
                yield name, _array(member, entry.file_size)


def _array(member: Any, size: int) -> np.ndarray:
    """Read one array, of at most `size` bytes with its header."""
    version = np.lib.format.read_magic(member)
    if version not in _HEADERS:
        raise ValueError(f"an array has the unknown version {version}")
    shape, column_major, dtype = _HEADERS[version](member, _LONGEST_HEADER)
    if dtype.kind not in _PLAIN_KINDS:
        raise ValueError(f"an array has the type {dtype}, which is not read")
    count = 1
    for length in shape:
        if length < 0:
            raise ValueError("an array has a negative length")
        count *= length
    if count * dtype.itemsize > size:
        raise ValueError("an array is cut off")
    data = member.read(count * dtype.itemsize)
    if len(data) != count * dtype.itemsize or member.read(1):
        raise ValueError("an array has another length than its header says")
    array = np.frombuffer(data, dtype, count=count) if dtype.itemsize else np.zeros(count, dtype)
    return array.reshape(shape, order="F" if column_major else "C")


def tensor_shapes(path: Path) -> dict[str, tuple[int, ...]]:
    """Return names and shapes from the header of a safetensors file; no array is read.

    Raises:
        FileError: The file cannot be read, or is not a safetensors file.
    """
    with _safetensors(path) as file:
        names = list(file.keys())
        if len(names) > MEMBERS * MEMBERS:
            raise FileError(path, f"expected at most {MEMBERS * MEMBERS} tensors, got {len(names)}")
        return {name: tuple(file.get_slice(name).get_shape()) for name in names}


def read_tensors(path: Path, shapes: Mapping[str, Any]) -> dict[str, np.ndarray]:
    """Read arrays of real numbers (float32) from a safetensors file.

    Args:
        path: The file.
        shapes: Names of the arrays, after their shapes were compared with `tensor_shapes`.

    Raises:
        FileError: The file cannot be read, or an array is of another type.
    """
    with _safetensors(path) as file:
        try:
            arrays = {name: file.get_tensor(name) for name in shapes}
        except Exception as error:  # whatever the library makes of a damaged file
            raise FileError(path, f"the arrays cannot be read: {error}") from None
    for name, array in arrays.items():
        if array.dtype != np.float32:
            raise FileError(path, f"tensor {name!r} is {array.dtype}, expected float32")
    return arrays


def _safetensors(path: Path) -> Any:
    from safetensors import safe_open

    open_regular(path, "tensors").close()
    try:
        return safe_open(path, framework="np")
    except Exception as error:  # its own, and whatever Python makes of a damaged header
        raise FileError(path, f"not a readable safetensors file: {error}") from None
