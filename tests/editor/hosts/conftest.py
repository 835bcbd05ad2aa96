"""Runs the app itself, as a process of its own."""

import ctypes
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

SCRIPTS = Path(__file__).resolve().parents[1] / "scripts"
_PACKAGES = "see scripts/system-packages.txt"


@pytest.fixture(scope="session")
def software_gl() -> None:
    """Skips where the system's software OpenGL is missing."""
    for library in ("libEGL.so.1", "libGL.so.1"):
        try:
            ctypes.CDLL(library)
        except OSError:
            pytest.skip(
                f"{library} is missing: install libegl1 libgl1-mesa-dri libgl1 ({_PACKAGES})"
            )


@pytest.fixture(scope="session")
def x_server() -> None:
    """Skips where the programs of the test with a real X server are missing."""
    missing = [name for name in ("Xvfb", "xdotool", "xprop") if shutil.which(name) is None]
    if missing:
        pytest.skip(
            f"{', '.join(missing)} missing: install xvfb xauth xdotool x11-utils ({_PACKAGES})"
        )


@pytest.fixture
def home(tmp_path: Path) -> dict[str, str]:
    """An environment with temporary user folders; what was compiled is kept between tests."""
    cache = os.environ.get("JAX_COMPILATION_CACHE_DIR", str(tmp_path / "jax"))
    return os.environ | {
        "XDG_STATE_HOME": str(tmp_path / "state"),
        "XDG_CONFIG_HOME": str(tmp_path / "config"),
        "XDG_CACHE_HOME": str(tmp_path / "cache"),
        "XDG_DATA_HOME": str(tmp_path / "data"),
        "XDG_DOCUMENTS_DIR": str(tmp_path / "documents"),
        "JAX_COMPILATION_CACHE_DIR": cache,
        "SDL_AUDIODRIVER": "dummy",
    }


@pytest.fixture
def script(tmp_path: Path) -> Callable[..., Path]:
    """Puts a script of tests/editor/scripts, with its outputs in a temporary folder, on disk."""

    def make(name: str, *before: str) -> Path:
        text = (SCRIPTS / name).read_text(encoding="utf-8").replace("OUT/", f"{tmp_path}/")
        target = tmp_path / name
        target.write_text("\n".join([*before, text]), encoding="utf-8")
        return target

    return make


@pytest.fixture
def run_editor(home: dict[str, str]) -> Callable[..., subprocess.CompletedProcess[str]]:
    """Runs `python -m editor` and returns what came out."""

    def run(*arguments: str, timeout: float = 300) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "editor", *arguments]
        return subprocess.run(
            command, env=home, capture_output=True, text=True, timeout=timeout, check=False
        )

    return run
