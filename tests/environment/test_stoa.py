"""Stoa's and envelope's interfaces, over the real packages."""

import sys
from pathlib import Path

import pytest

from kinetix.environment.stoa import as_stoa_env
from kinetix.errors import KinetixError
from tests.isolated import python_with, run_with

SCRIPTS = Path(__file__).parent / "stoa_scripts"


@pytest.mark.slow
def test_the_real_stoa(tmp_path: Path) -> None:
    python = python_with(tmp_path / "venv", "stoa-env", "gymnax==0.0.9", "six")
    run_with(python, SCRIPTS / "time_steps.py")


@pytest.mark.slow
@pytest.mark.skipif(sys.version_info < (3, 12), reason="envelope needs Python 3.12")
def test_the_real_envelope(tmp_path: Path) -> None:
    python = python_with(tmp_path / "venv", "jax-envelope>=0.6", "gymnax==0.0.9", "six")
    run_with(python, SCRIPTS / "envelope_adapter.py")


def test_without_stoa_one_sentence_says_so(small_env, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "stoa.environment", None)
    with pytest.raises(KinetixError, match="pip install stoa-env"):
        as_stoa_env(small_env)
