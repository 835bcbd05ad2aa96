"""Environments for packages that are no dependency: theirs besides everything that we have."""

import os
import subprocess
import sys
import sysconfig
import venv
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


def python_with(folder: Path, *packages: str) -> Path:
    """Return an interpreter that has these packages, and everything else from the one that tests.

    The test is skipped where pip cannot install them.

    Args:
        folder: Where the environment is made.
        *packages: As pip takes them.
    """
    venv.create(folder)
    python = folder / "bin" / "python"
    report = subprocess.run(
        [python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))"],
        capture_output=True,
        text=True,
        check=True,
    )
    borrowed = Path(report.stdout.strip()) / "borrowed.pth"
    borrowed.write_text(sysconfig.get_path("purelib") + "\n")
    installed = subprocess.run(
        [
            sys.executable,
            "-m",
            "pip",
            "--python",
            python,
            "install",
            "--quiet",
            "--no-compile",
            *packages,
        ],
        capture_output=True,
        text=True,
        timeout=400,
        check=False,
    )
    if installed.returncode:
        told = installed.stderr.strip()[-200:]
        pytest.skip(f"pip cannot install {' '.join(packages)}: {told}")
    return python


def run_with(
    python: Path, script: Path, *words: str, cwd: Path | None = None, seconds: float = 500
) -> str:
    """Run a script with our packages in reach and return what it printed.

    Args:
        python: From `python_with`.
        script: What to run.
        *words: Its arguments.
        cwd: Where; by default here.
        seconds: It is ended after so long.
    """
    result = subprocess.run(
        [python, script, *words],
        capture_output=True,
        text=True,
        timeout=seconds,
        check=False,
        cwd=cwd,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
    )
    assert result.returncode == 0, result.stderr[-3000:]
    return result.stdout
