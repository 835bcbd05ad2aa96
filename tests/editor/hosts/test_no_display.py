"""Without a display the app says so, whatever the environment claims."""

import subprocess
import sys

import pytest

from tests.editor.hosts.test_tour import ROOT

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="only there a display may be gone")


@pytest.fixture(params=["none", "gone"])
def blind(request, home):
    """An environment without a display, or with the name of one that does not answer."""
    names = ("DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER")
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
    assert "Traceback" not in done.stderr


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
