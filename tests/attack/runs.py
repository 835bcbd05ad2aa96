"""Readers of training runs: metrics, states, hyper-parameters."""

import functools
import json
import tempfile
from pathlib import Path

import numpy as np


def metrics() -> tuple[bytes, ...]:
    row = {"timing/num_updates": 1, "timing/num_env_steps": 32, "loss/total": 0.5}
    return ("\n".join(json.dumps(row | {"timing/num_updates": k}) for k in range(1, 20)).encode(),)


def read_rows(data: bytes, folder: Path) -> None:
    from kinetix.training.logging import MetricsLog, read_metrics

    (folder / "metrics.jsonl").write_bytes(data)
    before = read_metrics(folder)
    MetricsLog(folder, updates=10**9).close()
    kept = [row for row in before if row["timing/num_updates"] <= 10**9]
    assert kept == read_metrics(folder)


@functools.cache
def stored_state() -> tuple[bytes, ...]:
    """The files of a checkpoint with a state, each with its name in the first line."""
    from kinetix.training.resume import StoredProgress, write_state

    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        write_state(folder, _STATE, StoredProgress(updates=1, seconds=0.5))
        files = [path for path in sorted(folder.rglob("*")) if path.is_file()]
        return tuple(f"{p.relative_to(folder)}\n".encode() + p.read_bytes() for p in files)


_STATE = {"a": np.arange(6, dtype=np.float32), "b": np.ones((2, 2), np.int32)}


def read_state(data: bytes, folder: Path) -> None:
    from kinetix.training.resume import read_newest

    checkpoint = folder / "checkpoints" / "32"
    names = []
    for stored in stored_state():
        name, _, content = stored.partition(b"\n")
        path = checkpoint / name.decode()
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
        names.append(name)
    name, _, content = data.partition(b"\n")
    path = checkpoint / (name if name in names else b"progress.json").decode()
    path.write_bytes(content)
    found = read_newest(folder, lambda: _STATE, lambda text: None)
    assert found is not None
    for key, array in _STATE.items():
        np.testing.assert_array_equal(found[0][key], array)


def configs() -> tuple[bytes, ...]:
    from kinetix.training.settings import dumps_config, make_config

    return tuple(dumps_config(a, make_config(a)).encode() for a in ("ppo", "plr"))


def read_config(data: bytes, folder: Path) -> None:
    from kinetix.training.settings import make_config

    (folder / "config.toml").write_bytes(data)
    make_config("ppo", run=folder)
