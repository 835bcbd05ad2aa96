"""Trees of arrays on disk: orbax directories, which hold JSON and numbers, nothing that runs."""

import errno
import hashlib
import os
import shutil
import stat
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import jax
import numpy as np

from kinetix.errors import CheckpointError
from kinetix.files.limits import CHECKPOINT_FILES, LIMITS, MIB

Tree = Mapping[str, Any]
"""Nested dictionaries whose leaves are arrays (or shapes and dtypes)."""

_NO_ROOM = (errno.ENOSPC, errno.EFBIG, errno.EDQUOT)
"""The system's reasons for not writing so much."""
_MANY = 3
"""Differing tensors that a sentence names; further ones are only counted."""


def flatten(tree: Tree, prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Leaves with their paths joined by "/", in the order of the names."""
    for key in sorted(tree):
        value = tree[key]
        if isinstance(value, Mapping):
            yield from flatten(value, f"{prefix}{key}/")
        else:
            yield f"{prefix}{key}", value


def unflatten(leaves: Iterable[tuple[str, Any]]) -> dict[str, Any]:
    """Return the tree that `flatten` took apart."""
    root: dict[str, Any] = {}
    for path, value in leaves:
        *parents, leaf = path.split("/")
        node = root
        for parent in parents:
            node = node.setdefault(parent, {})
        node[leaf] = value
    return root


def digest(tree: Tree) -> str:
    """SHA-256 over names, dtypes, shapes and bytes of all leaves."""
    state = hashlib.sha256()
    for name, leaf in flatten(tree):
        array = np.ascontiguousarray(leaf)
        state.update(f"{name}|{array.dtype.str}|{array.shape}|".encode())
        state.update(array.tobytes())
    return state.hexdigest()


def compare_shapes(where: Path, expected: Mapping[str, Any], found: Mapping[str, Any]) -> None:
    """Check names and shapes of tensors.

    Args:
        where: The file or directory, for the sentence.
        expected: Shape of every tensor that must be there.
        found: Shape of every tensor that is there.

    Raises:
        CheckpointError: Tensors are missing, superfluous or of another shape; the message names the
            first few.
    """
    problems = [f"tensor {name!r} is missing" for name in sorted(expected.keys() - found.keys())]
    for name in sorted(expected.keys() & found.keys()):
        if tuple(expected[name]) != tuple(found[name]):
            problems.append(
                f"tensor {name!r} has the shape {tuple(found[name])}, "
                f"expected {tuple(expected[name])}"
            )
    problems += [f"tensor {name!r} is unknown" for name in sorted(found.keys() - expected.keys())]
    if problems:
        rest = len(problems) - _MANY
        more = f" (and {rest} more)" if rest > 0 else ""
        raise CheckpointError(f"{where}: {'; '.join(problems[:_MANY])}{more}")


def write_arrays(directory: Path, tree: Tree) -> None:
    """Write a tree of arrays.

    Args:
        directory: Made by this call; must not exist.
        tree: Nested dictionaries of arrays.

    Raises:
        OSError: The system refused; the reason alone, as the folder may have a passing name.
    """
    # Importing orbax takes a second; only those who save or load pay for it.
    import orbax.checkpoint as ocp

    host = jax.tree.map(np.asarray, dict(tree))
    _check_room(directory, sum(leaf.nbytes for _, leaf in flatten(host)))
    # Orbax and tensorstore have errors of their own for a full disk, with pages of context.
    try:
        with ocp.StandardCheckpointer(multiprocessing_options=_alone()) as checkpointer:
            checkpointer.save(directory.resolve(), host)
    except Exception as error:
        raise OSError(_reason(error)) from None
    # It holds the folder in which the arrays were written; nothing reads it.
    (directory / "commit_success.txt").unlink(missing_ok=True)


def _check_room(directory: Path, size: int) -> None:
    """Raise if there is no room for so many bytes: orbax would report it in hundreds of lines."""
    needed = size + size // 8 + 2 * MIB
    free = shutil.disk_usage(directory.parent).free
    if free < needed:
        raise OSError(
            f"No space left on device: {needed // MIB} MiB are needed, {free // MIB} MiB are free"
        )
    if not hasattr(os, "posix_fallocate"):
        return
    # Quotas and limits on the size of files show only where the room is taken.
    with tempfile.TemporaryFile(dir=directory.parent) as trial:
        try:
            os.posix_fallocate(trial.fileno(), 0, max(size, 1))
        except OSError as error:
            if error.errno in _NO_ROOM:
                raise OSError(error.strerror) from None


def read_arrays(directory: Path, shapes: Tree) -> dict[str, Any]:
    """Read a tree of arrays, after checking that it is the expected one.

    Args:
        directory: Written by `write_arrays`.
        shapes: Nested dictionaries with a `jax.ShapeDtypeStruct` for every array.

    Returns:
        The tree, with numpy arrays as leaves.

    Raises:
        CheckpointError: The directory is missing, damaged, reaches outside itself, or holds
            other arrays.
    """
    import orbax.checkpoint as ocp

    check_inside(directory)
    # Orbax and tensorstore raise whatever their file formats lead them to; here it is all the
    # same: these arrays cannot be read.
    try:
        _list_entries(directory)
        with ocp.StandardCheckpointer(multiprocessing_options=_alone()) as checkpointer:
            metadata: Any = checkpointer.metadata(directory.resolve())
        stored = dict(flatten(metadata.item_metadata.tree))
    except Exception as error:
        raise _damaged(directory, error) from None
    expected = dict(flatten(shapes))
    compare_shapes(
        directory,
        {name: leaf.shape for name, leaf in expected.items()},
        {name: leaf.shape for name, leaf in stored.items()},
    )
    for name, leaf in expected.items():
        if np.dtype(stored[name].dtype) != np.dtype(leaf.dtype):
            raise CheckpointError(
                f"{directory}: tensor {name!r} is of type {stored[name].dtype}, "
                f"expected {leaf.dtype}"
            )
    try:
        return unflatten((name, _read_leaf(directory, name)) for name in expected)
    except Exception as error:
        raise _damaged(directory, error) from None


def _list_entries(directory: Path) -> None:
    """Go through the index of what is stored; it raises where files of it are missing.

    Orbax would ask for all arrays at once, and print tracebacks of those that are still under way.
    """
    import tensorstore

    kvstore = {"driver": "ocdbt", "base": f"file://{directory.resolve()}/"}
    tensorstore.KvStore.open(kvstore).result().list().result()


def _read_leaf(directory: Path, name: str) -> np.ndarray:
    """Read one array with the library that orbax stores arrays with.

    Orbax itself reads all of them at once, and where one is damaged it leaves while the others are
    still under way: these then print tracebacks about an event loop that is closed.
    """
    import tensorstore

    kvstore = {
        "driver": "ocdbt",
        "base": f"file://{directory.resolve()}/",
        "path": f"{name.replace('/', '.')}/",
    }
    store = tensorstore.open({"driver": "auto", "kvstore": kvstore}, read=True, open=True)
    return np.asarray(store.result().read().result())


def _alone() -> Any:
    """Options without a barrier: of several training processes only one writes."""
    import orbax.checkpoint as ocp

    if jax.process_count() == 1:
        return ocp.options.MultiprocessingOptions()
    here = jax.process_index()
    return ocp.options.MultiprocessingOptions(
        primary_host=here, active_processes={here}, barrier_sync_key_prefix=f"process_{here}"
    )


def check_inside(directory: Path) -> None:
    """Refuse a directory whose reading could leave it, wait for ever or fill the memory.

    Raises:
        CheckpointError: The directory is missing, its links lead out of it, it holds something
            other than regular files (opening a pipe waits for its writer), or more than the limits
            allow.
    """
    if not os.path.isdir(directory):
        raise CheckpointError(f"{directory}: expected a directory of parameters, found none")
    try:
        root = directory.resolve()
        total = 0
        for count, path in enumerate(directory.rglob("*")):
            if count >= CHECKPOINT_FILES:
                raise CheckpointError(f"{directory}: expected at most {CHECKPOINT_FILES} files")
            if path.is_symlink() and not path.resolve().is_relative_to(root):
                raise CheckpointError(
                    f"{path}: this link leads out of the checkpoint; it is not read"
                )
            status = path.stat()
            if stat.S_ISREG(status.st_mode):
                total += status.st_size
            elif not stat.S_ISDIR(status.st_mode):
                raise CheckpointError(
                    f"{path}: expected a regular file, got a device, pipe or socket"
                )
    except (OSError, RuntimeError) as error:  # RuntimeError: a link to itself
        raise CheckpointError(f"{directory}: cannot be read: {error}") from None
    largest = LIMITS["tensors"].largest
    if total > largest:
        raise CheckpointError(f"{directory}: expected at most {largest // MIB} MiB")


def _damaged(directory: Path, error: Exception) -> CheckpointError:
    return CheckpointError(
        f"{directory}: the arrays cannot be read ({_reason(error)}); take another checkpoint, or "
        "a copy of this one"
    )


def _reason(error: Exception) -> str:
    """Return the system's own message out of pages of context, or else the first line."""
    if isinstance(error, (AttributeError, KeyError, TypeError)):  # met where a part is not there
        return "one of their files is missing or damaged"
    text = str(error).strip()
    for said in map(os.strerror, (*_NO_ROOM, errno.EACCES, errno.EROFS)):
        if said in text:
            return said
    if "OUT_OF_RANGE" in text:
        return "one of their files is shorter than it was"
    return text.split("\n", 1)[0][:200] or type(error).__name__
