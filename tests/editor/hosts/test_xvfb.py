"""The app on a real X server with real keys and a real mouse."""

import contextlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from kinetix.failures import INTERRUPTED, TERMINATED
from kinetix.level.codec import load_level
from kinetix.paths import levels_dir
from tests.editor import days
from tests.editor.hosts.processes import end, start

pytestmark = [pytest.mark.xvfb, pytest.mark.usefixtures("x_server", "software_gl")]


class Desktop:
    """An X server of our own with the app on it."""

    def __init__(self, level: Path, home: dict[str, str], ends: contextlib.ExitStack) -> None:
        read, write = os.pipe()
        server = start(
            [
                *("Xvfb", "-displayfd", str(write), "-screen", "0", "1280x800x24"),
                # Else it starts over when the last client leaves, while the app may be connecting.
                *("-nolisten", "tcp", "-noreset"),
            ],
            pass_fds=[write],
            stderr=subprocess.DEVNULL,
        )
        ends.callback(end, server)
        os.close(write)
        with os.fdopen(read) as stream:
            number = stream.readline().strip()
        self._env = home | {
            "DISPLAY": f":{number}",
            "SDL_VIDEODRIVER": "x11",
            "LIBGL_ALWAYS_SOFTWARE": "1",
            "LP_NUM_THREADS": "1",
        }
        self.app = start(
            [sys.executable, "-m", "editor", "--size", "1200x760", "--scale", "1", str(level)],
            env=self._env,
            stderr=subprocess.PIPE,
        )
        ends.callback(end, self.app)

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


@pytest.fixture(params=[*days.DAYS, "after version 0.1.0"])
def desktop(request, home, tmp_path, yesterday):
    if request.param == days.SECOND:
        days.put(yesterday, tmp_path)
    elif request.param != days.FIRST:
        days.put_old(tmp_path)
    level = tmp_path / "mine.json"
    shutil.copy(levels_dir() / "l" / "rover_ridge.json", level)
    with contextlib.ExitStack() as ends:
        desktop = Desktop(level, home, ends)
        if request.param == days.SECOND:
            # Yesterday's unsaved work is asked about: not now.
            desktop.do("windowfocus", "--sync", desktop.window())
            time.sleep(1.0)
            desktop.do("key", "Escape")
        yield desktop


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux tells children of a parent's end")
def test_what_a_killed_test_run_started_ends_with_it():
    code = (
        "from tests.editor.hosts.processes import start; "
        "print(start(['sleep', '300']).pid, flush=True); import time; time.sleep(300)"
    )
    run = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
    child = int(run.stdout.readline())
    process = Path(f"/proc/{child}/cmdline")

    def command() -> str:
        return process.read_text() if process.exists() else ""

    deadline = time.monotonic() + 20
    while "sleep\0" not in command()[:6] and time.monotonic() < deadline:
        time.sleep(0.05)
    assert command().startswith("sleep")
    run.kill()
    run.wait(60)
    run.stdout.close()
    while command() and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not command()


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


@pytest.mark.parametrize(
    ("number", "status", "word"),
    [
        (signal.SIGTERM, TERMINATED, "terminated"),
        (signal.SIGHUP, TERMINATED, "terminated"),
        (signal.SIGINT, INTERRUPTED, "interrupted"),
    ],
)
def test_a_signal_closes_the_window_and_keeps_a_copy_of_unsaved_work(
    home, tmp_path, number, status, word
):
    level = tmp_path / "mine.json"
    shutil.copy(levels_dir() / "s" / "first_flight.json", level)
    with contextlib.ExitStack() as ends:
        desktop = Desktop(level, home, ends)
        desktop.do("windowfocus", "--sync", desktop.window())
        time.sleep(1.0)
        desktop.do("key", "ctrl+a")
        desktop.do("key", "Delete")
        desktop.until(lambda: desktop.title().startswith("●"))
        desktop.app.send_signal(number)
        assert desktop.app.wait(60) == status
        assert desktop.app.stderr.read() == f"{word}\n"
    copies = (tmp_path / "state" / "kinetix-editor" / "autosave").glob("*/*[0-9].json")
    assert len(list(copies)) == 1
    assert load_level(level).bodies
    settings = json.loads((tmp_path / "config" / "kinetix-editor" / "settings.json").read_text())
    assert str(level) in settings["recents"] and settings["layout"]


def test_a_killed_window_is_restored_by_the_next(home, tmp_path):
    level = tmp_path / "mine.json"
    shutil.copy(levels_dir() / "s" / "first_flight.json", level)
    count = len(load_level(level).bodies)
    autosaves = tmp_path / "state" / "kinetix-editor" / "autosave"
    with contextlib.ExitStack() as ends:
        desktop = Desktop(level, home, ends)
        window = desktop.window()
        desktop.do("windowfocus", "--sync", window)
        time.sleep(1.0)
        desktop.do("key", "ctrl+a")
        desktop.do("key", "Delete")
        desktop.until(lambda: list(autosaves.glob("*/*[0-9].json")))
        settings = tmp_path / "config" / "kinetix-editor" / "settings.json"
        desktop.until(lambda: settings.is_file() and str(level) in settings.read_text())
        desktop.app.kill()
        desktop.app.wait(20)
    assert len(load_level(level).bodies) == count
    with contextlib.ExitStack() as ends:
        desktop = Desktop(level, home, ends)
        desktop.do("windowfocus", "--sync", desktop.window())
        time.sleep(2.0)
        desktop.do("key", "Return")
        desktop.until(lambda: desktop.title().startswith("●"))
        desktop.do("key", "ctrl+s")
        desktop.until(lambda: not load_level(level).bodies)
        desktop.do("key", "ctrl+q")
        desktop.app.wait(20)
        assert desktop.app.returncode == 0
    assert list(autosaves.iterdir()) == []
