"""Without a display the app says so, whatever the environment claims."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.editor.hosts.test_tour import ROOT

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="only there a display may be gone")


@pytest.fixture(params=["none", "gone"])
def blind(request, home):
    """An environment without a display, or with the name of one that does not answer."""
    names = ("DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER", "XDG_RUNTIME_DIR")
    environment = {key: value for key, value in home.items() if key not in names}
    return environment | ({"DISPLAY": ":4711"} if request.param == "gone" else {})


def test_it_says_so_and_what_works_instead(blind):
    done = subprocess.run(
        [sys.executable, "-m", "editor"],
        env=blind,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 1
    assert "There is no display" in done.stderr
    assert "kinetix-editor --serve" in done.stderr
    assert "--offscreen --replay" in done.stderr and "kinetix render" in done.stderr
    assert "Traceback" not in done.stderr and "XDG_RUNTIME_DIR" not in done.stderr


def test_make_run_notices(blind):
    code = "from editor.hosts.display import has_display; print(has_display())"
    done = subprocess.run(
        [sys.executable, "-c", code],
        env=blind,
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.split()[-1] == "False"


def test_a_current_folder_that_is_gone_is_said_and_replaced(tmp_path, monkeypatch, capsys):
    from editor.__main__ import _stand_somewhere

    gone, home = tmp_path / "gone", tmp_path / "home"
    gone.mkdir()
    home.mkdir()
    monkeypatch.setenv("HOME", str(home))
    monkeypatch.chdir(gone)
    _stand_somewhere()
    assert Path.cwd() == gone
    gone.rmdir()
    _stand_somewhere()
    assert Path.cwd() == home
    assert capsys.readouterr().err.count("the current folder is gone") == 1
