"""gymnax 0.0.9 and 1.x with the real packages, each in a virtual environment of its own."""

import os
import subprocess
import sys
import sysconfig
import venv
from pathlib import Path

import pytest

from kinetix.environment.gymnax import gymnax_spaces
from kinetix.errors import KinetixError

SCRIPTS = Path(__file__).parent / "gymnax_scripts"
ROOT = Path(__file__).resolve().parents[2]


def python_with_gymnax(folder: Path, version: str) -> Path:
    """An interpreter that has gymnax, and everything else from the one that runs the tests."""
    venv.create(folder, with_pip=True)
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
        [python, "-m", "pip", "install", "--quiet", f"gymnax=={version}", "six"],
        capture_output=True,
        text=True,
        timeout=400,
        check=False,
    )
    if installed.returncode:
        pytest.skip(f"pip cannot install gymnax {version}: {installed.stderr.strip()[-200:]}")
    return python


@pytest.mark.slow
@pytest.mark.parametrize(
    ("version", "script"), [("0.0.9", "five_values.py"), ("1.0.1", "six_values.py")]
)
def test_the_real_gymnax(tmp_path: Path, version: str, script: str) -> None:
    python = python_with_gymnax(tmp_path / "venv", version)
    result = subprocess.run(
        [python, SCRIPTS / script],
        capture_output=True,
        text=True,
        timeout=400,
        check=False,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
    )
    assert result.returncode == 0, result.stderr[-3000:]


def test_without_gymnax_one_sentence_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "gymnax.environments.spaces", None)
    with pytest.raises(KinetixError, match="pip install gymnax"):
        gymnax_spaces()
