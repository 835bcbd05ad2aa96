"""Number of cores, and where it is set."""

import os
import subprocess
import sys

import pytest

from kinetix.cores import available_cores, wanted_cores
from kinetix.errors import KinetixError


def test_all_cores_unless_the_variable_says_otherwise():
    assert wanted_cores({}) == available_cores() >= 1
    assert wanted_cores({"KINETIX_CORES": ""}) == available_cores()
    assert wanted_cores({"KINETIX_CORES": "3"}) == 3


@pytest.mark.parametrize("text", ["0", "-1", "many", "1.5"])
def test_what_is_no_number_of_cores_is_refused(text):
    with pytest.raises(KinetixError, match=f"KINETIX_CORES = {text}: expected a number of cores"):
        wanted_cores({"KINETIX_CORES": text})


@pytest.mark.parametrize(
    ("before", "call", "devices"),
    [
        ({"KINETIX_CORES": "3"}, "use_all_cores()", 3),
        ({"KINETIX_CORES": "3"}, "use_all_cores(2)", 2),
        ({"JAX_NUM_CPU_DEVICES": "4"}, "use_all_cores()", 4),
        ({"XLA_FLAGS": "--xla_force_host_platform_device_count=5"}, "use_all_cores()", 5),
    ],
)
def test_jax_sees_as_many_devices(before, call, devices):
    assert _run(
        before, f"import kinetix; kinetix.{call}; import jax; print(jax.device_count())"
    ) == (str(devices))


def test_too_late_is_said():
    said = _run(
        {"KINETIX_CORES": "2"},
        "import jax; jax.numpy.zeros(3)\n"
        "import kinetix\n"
        "try: kinetix.use_all_cores()\n"
        "except kinetix.KinetixError as error: print(error)",
    )
    assert said == (
        "JAX has started already, with 1 × cpu: call kinetix.use_all_cores() before the first "
        "array is made"
    )


def _run(variables, code):
    kept = {k: v for k, v in os.environ.items() if k not in ("XLA_FLAGS", "KINETIX_CORES")}
    done = subprocess.run(
        [sys.executable, "-c", code],
        env=kept | variables,
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.strip()
