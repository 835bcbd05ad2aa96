"""The editor plays on the processor where there is a GPU too, unless somebody says otherwise."""

import os
import subprocess
import sys

import pytest

SCRIPT = """
from editor.worker.simulation import start
start()
import jax
print(jax.config.jax_platforms)
"""


@pytest.mark.parametrize(("said", "taken"), [("", "cpu"), ("cuda,cpu", "cuda,cpu")])
def test_a_gpu_is_left_to_trainings(said, taken):
    variables = {**os.environ, "JAX_PLATFORMS": said}
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT], env=variables, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == taken
