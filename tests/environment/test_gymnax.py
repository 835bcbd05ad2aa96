"""gymnax 0.0.9 and 1.x with the real packages, each in a virtual environment of its own."""

import sys
from pathlib import Path

import pytest

from kinetix.environment.gymnax import gymnax_spaces
from kinetix.errors import KinetixError
from tests.isolated import python_with, run_with

SCRIPTS = Path(__file__).parent / "gymnax_scripts"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("version", "script"), [("0.0.9", "five_values.py"), ("1.0.1", "six_values.py")]
)
def test_the_real_gymnax(tmp_path: Path, version: str, script: str) -> None:
    python = python_with(tmp_path / "venv", f"gymnax=={version}", "six")
    run_with(python, SCRIPTS / script)


def test_without_gymnax_one_sentence_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "gymnax.environments.spaces", None)
    with pytest.raises(KinetixError, match="pip install gymnax"):
        gymnax_spaces()
