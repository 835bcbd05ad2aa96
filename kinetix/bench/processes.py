"""Measurements of ours in new processes: the number of devices is fixed when one starts."""

import json
import os
import subprocess
import sys
from typing import Any

from kinetix.errors import KinetixError
from kinetix.paths import cache_dir


def measured_apart(*words: str, devices: int, cached: bool = False) -> list[dict[str, Any]]:
    """Return the rows that `kinetix bench WORDS` prints in a new process.

    Args:
        words: The sub-command and its options, without `--json`.
        devices: How many devices the process sees on the CPU.
        cached: Take compiled programs from the user's cache; then compile times mean nothing.

    Raises:
        KinetixError: The process failed; with its own message.
    """
    variables = {**os.environ, "JAX_PLATFORMS": "cpu", **host_devices(devices)}
    if cached:
        variables.setdefault("JAX_COMPILATION_CACHE_DIR", str(cache_dir() / "jax"))
        # XLA calls its own tuning hints unknown processor features when it reads that cache.
        variables.setdefault("TF_CPP_MIN_LOG_LEVEL", "3")
    done = subprocess.run(
        [sys.executable, "-m", "kinetix", "bench", *words, "--json"],
        env=variables,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        raise KinetixError(f"kinetix bench {words[0]}: {done.stderr.strip()}")
    return [json.loads(line) for line in done.stdout.splitlines()]


def host_devices(count: int) -> dict[str, str]:
    """Variables of a process that shall see so many devices on the CPU."""
    flags = [flag for flag in os.environ.get("XLA_FLAGS", "").split() if "device_count" not in flag]
    return {"XLA_FLAGS": " ".join([*flags, f"--xla_force_host_platform_device_count={count}"])}
