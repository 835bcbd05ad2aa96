"""One batch over two devices, and over two processes: the same numbers as on one."""

import json
import os
import socket
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

WORKER = Path(__file__).parent / "device_scripts" / "worker.py"
ROOT = Path(__file__).resolve().parents[2]
WORLDS = 4


def start_worker(devices: int, *arguments: int) -> subprocess.Popen:
    return subprocess.Popen(
        [sys.executable, WORKER, str(WORLDS), *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONPATH": str(ROOT), "JAX_NUM_CPU_DEVICES": str(devices)},
    )


def result_of(worker: subprocess.Popen) -> tuple[int, np.ndarray]:
    out, errors = worker.communicate(timeout=300)
    assert worker.returncode == 0, errors[-3000:]
    report = json.loads(out.splitlines()[-1])
    return report["devices"], np.array(report["observations"])


@pytest.mark.slow
def test_two_devices_and_two_processes_equal_one() -> None:
    devices, alone = result_of(start_worker(1))
    assert devices == 1
    assert len(alone) == WORLDS
    assert len(np.unique(alone, axis=0)) == WORLDS
    devices, on_two = result_of(start_worker(2))
    assert devices == 2
    np.testing.assert_allclose(on_two, alone, atol=1e-5)
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    workers = [start_worker(1, 2, index, port) for index in range(2)]
    try:
        shares = [result_of(worker) for worker in workers]
    finally:
        for worker in workers:
            worker.kill()
    assert [devices for devices, _ in shares] == [2, 2]
    together = np.concatenate([observations for _, observations in shares])
    np.testing.assert_allclose(together, alone, atol=1e-5)
