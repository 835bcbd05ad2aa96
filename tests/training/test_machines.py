"""Two processes that find each other over the network learn what one of them learns."""

import os
import socket
import subprocess
import sys

import numpy as np
import pytest

from kinetix.agents.agent import load_agent
from kinetix.agents.arrays import flatten
from kinetix.agents.checkpoint import steps_of_run
from kinetix.errors import KinetixError
from kinetix.training.devices import join
from kinetix.training.logging import read_metrics

_VALUES = {
    "size": "s",
    "num-train-envs": 8,
    "num-steps": 8,
    "num-minibatches": 2,
    "update-epochs": 2,
    "observation-type": "symbolic_flat",
    "physics": "jax2d",
    "actor-depth": 1,
    "critic-depth": 1,
    "actor-width": 16,
    "critic-width": 16,
    "eval-freq": 0,
    "checkpoint-save-freq": 2,
    # A run whose rate falls cannot be made longer.
    "anneal-lr": False,
}


def _command(out, updates, *more):
    values = _VALUES | {"total-timesteps": 8 * 8 * updates, "out": out}
    flags = [word for name, value in values.items() for word in (f"--{name}", str(value))]
    return [sys.executable, "-m", "kinetix", "train", "ppo", "--dummy-env", *flags, *more]


def _together(out, updates):
    """Run the command in two processes; what they print, by process."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    shared = ("--coordinator", f"127.0.0.1:{port}", "--num-processes", "2")
    # One device each, whatever the tests run on.
    flags = [flag for flag in os.environ["XLA_FLAGS"].split() if "device_count" not in flag]
    environment = os.environ | {"XLA_FLAGS": " ".join(flags), "JAX_PLATFORMS": "cpu"}
    processes = [
        subprocess.Popen(
            _command(out, updates, *shared, "--process-id", str(index)),
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        for index in range(2)
    ]
    results = [process.communicate(timeout=400) for process in processes]
    assert [process.returncode for process in processes] == [0, 0], results
    return [output for output, _ in results]


@pytest.mark.slow
def test_two_processes_learn_what_one_learns_and_go_on_where_they_stopped(tmp_path):
    subprocess.run(_command(tmp_path / "one", 4), check=True, capture_output=True)
    first, second = _together(tmp_path / "two", 2)
    assert first.strip().endswith("checkpoints/128")
    assert "checkpoints" not in second
    _together(tmp_path / "two", 4)
    assert steps_of_run(tmp_path / "two") == [128, 256]

    # Nothing ends in this environment, so the losses tell; that a real one is split over devices as
    # well is shown in test_devices.py.
    one, two = (read_metrics(tmp_path / name) for name in ("one", "two"))
    assert len(one) == len(two) == 4
    for a, b in zip(one, two, strict=True):
        untimed = [name for name in a if name not in ("timing/sps", "timing/seconds")]
        assert {n: b[n] for n in untimed} == pytest.approx(
            {n: a[n] for n in untimed}, rel=1e-3, abs=1e-4
        )
    a, b = (dict(flatten(load_agent(tmp_path / n).params["params"])) for n in ("one", "two"))
    for name, leaf in a.items():
        np.testing.assert_allclose(b[name], leaf, rtol=1e-2, atol=1e-4, err_msg=name)


def test_processes_must_be_told_how_many_they_are():
    with pytest.raises(KinetixError, match="num_processes and process_id are needed too"):
        join("127.0.0.1:1", num_processes=2, process_id=None)
