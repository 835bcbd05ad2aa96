"""The app on a real X server with real keys and a real mouse."""

import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

from kinetix.level.codec import load_level
from kinetix.paths import levels_dir

pytestmark = [pytest.mark.xvfb, pytest.mark.usefixtures("x_server", "software_gl")]


class Desktop:
    """An X server of our own with the app on it."""

    def __init__(self, level: Path, home: dict[str, str]) -> None:
        read, write = os.pipe()
        self._server = subprocess.Popen(
            ["Xvfb", "-displayfd", str(write), "-screen", "0", "1280x800x24", "-nolisten", "tcp"],
            pass_fds=[write],
            stderr=subprocess.DEVNULL,
        )
        os.close(write)
        with os.fdopen(read) as stream:
            number = stream.readline().strip()
        self._env = home | {
            "DISPLAY": f":{number}",
            "SDL_VIDEODRIVER": "x11",
            "LIBGL_ALWAYS_SOFTWARE": "1",
            "LP_NUM_THREADS": "1",
        }
        self.app = subprocess.Popen(
            [sys.executable, "-m", "editor", "--size", "1200x760", "--scale", "1", str(level)],
            env=self._env,
            stderr=subprocess.PIPE,
            text=True,
        )

    def do(self, *arguments: str) -> str:
        done = subprocess.run(
            ["xdotool", *arguments],
            env=self._env,
            capture_output=True,
            text=True,
            timeout=30,
            check=False,
        )
        return done.stdout.strip()

    def window(self) -> str:
        return self.until(lambda: self.do("search", "--class", "kinetix-editor").split("\n")[-1])

    def title(self) -> str:
        command = ["xprop", "-id", self.window(), "-notype", "_NET_WM_NAME"]
        done = subprocess.run(
            command, env=self._env, capture_output=True, text=True, timeout=30, check=False
        )
        return done.stdout.partition('"')[2]

    def until(self, value, seconds: float = 30.0):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            found = value()
            if found:
                return found
            assert self.app.poll() is None, self.app.stderr.read()
            time.sleep(0.1)
        raise AssertionError("timed out")

    def close(self) -> None:
        for process in (self.app, self._server):
            if process.poll() is None:
                # SDL makes a question of SIGTERM, as of the window's close button.
                process.kill()
                process.wait(10)
        self.app.stderr.close()


@pytest.fixture
def desktop(home, tmp_path):
    level = tmp_path / "mine.json"
    shutil.copy(levels_dir() / "l" / "rover_ridge.json", level)
    desktop = Desktop(level, home)
    yield desktop
    desktop.close()


def test_draws_with_the_mouse_saves_with_the_keyboard_and_quits(desktop, tmp_path):
    level = tmp_path / "mine.json"
    before = load_level(level)
    window = desktop.window()
    desktop.until(lambda: "mine.json" in desktop.title())
    desktop.do("windowfocus", "--sync", window)
    time.sleep(1.0)
    desktop.do("mousemove", "--window", window, "600", "300")
    desktop.do("key", "c")
    for step in ("mousedown", None, "mouseup"):
        if step is None:
            for x in range(605, 650, 5):
                desktop.do("mousemove", "--window", window, str(x), "300")
        else:
            desktop.do(step, "1")
    desktop.until(lambda: desktop.title().startswith("●"))
    desktop.do("key", "ctrl+s")
    desktop.until(lambda: len(load_level(level).bodies) == len(before.bodies) + 1)
    assert (tmp_path / "mine.json.bak").is_file()
    desktop.do("key", "ctrl+z")
    desktop.until(lambda: desktop.title().startswith("●"))
    desktop.do("key", "ctrl+q")
    time.sleep(0.5)
    # Unsaved changes: it asks, Escape keeps the app, the answer "Don't Save" ends it.
    assert desktop.app.poll() is None
    desktop.do("key", "Escape")
    desktop.do("key", "ctrl+y")
    desktop.until(lambda: not desktop.title().startswith("●"))
    desktop.do("key", "ctrl+q")
    desktop.app.wait(20)
    assert desktop.app.returncode == 0
    recents = json.loads((tmp_path / "config" / "kinetix-editor" / "settings.json").read_text())
    assert str(level) in recents["recents"][0]
