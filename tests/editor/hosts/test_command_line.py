"""The command line of the app: options that cannot be meant, and its end by signals."""

import contextlib
import json
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from editor.__main__ import Options, _check, _size
from kinetix.errors import KinetixError
from kinetix.failures import TERMINATED
from tests.editor.hosts.processes import end, start


@pytest.mark.parametrize("scale", ["nan", "inf", "-inf", "0", "-1", "0.7", "3.1", "100"])
def test_a_scale_that_nothing_can_be_read_at_is_refused(scale):
    with pytest.raises(KinetixError, match=rf"^--scale {scale}: expected 0\.75 to 3, such as"):
        _check(Options(scale=float(scale)))


@pytest.mark.parametrize("scale", [None, 0.75, 1.0, 3.0])
def test_the_scales_that_the_help_names_are_taken(scale):
    _check(Options(scale=scale))


@pytest.mark.parametrize("size", ["100000x100000", "800x8193", f"{'9' * 5000}x600"])
def test_a_size_that_no_window_has_is_refused(size):
    with pytest.raises(KinetixError, match=r"^--size .*: expected at most 8192x8192$"):
        _size(size)


@pytest.mark.parametrize(
    ("words", "status", "said"),
    [
        (["--help"], 0, r"--scale FLOAT .* --port INT"),
        (["--scale", "big"], 2, r"--scale: expected a number, got 'big'"),
    ],
)
def test_the_help_and_mistakes_are_worded_as_those_of_every_command(words, status, said, home):
    command = [sys.executable, "-m", "editor", *words]
    done = subprocess.run(
        command, check=False, env=home, capture_output=True, text=True, timeout=120
    )
    told = done.stdout + done.stderr
    assert done.returncode == status
    assert re.search(said, " ".join(told.split()).replace("│ ", "")) and "{None" not in told


def listens(pid: int) -> bool:
    """Return whether a process takes SIGTERM itself."""
    (caught,) = re.findall(r"^SigCgt:\s*(\w+)$", Path(f"/proc/{pid}/status").read_text(), re.M)
    return bool(int(caught, 16) >> (signal.SIGTERM - 1) & 1)


def until(value: Callable[[], bool], seconds: float = 60.0) -> None:
    deadline = time.monotonic() + seconds
    while not value():
        assert time.monotonic() < deadline, "timed out"
        time.sleep(0.05)


@pytest.fixture
def begin(home):
    """Starts the app; what a test leaves running ends with it."""
    with contextlib.ExitStack() as ends:

        def run(*words: str) -> subprocess.Popen[str]:
            app = start([sys.executable, "-m", "editor", *words], env=home, stderr=subprocess.PIPE)
            ends.callback(end, app)
            return app

        yield run


@pytest.mark.gl
@pytest.mark.usefixtures("software_gl")
@pytest.mark.skipif(sys.platform != "linux", reason="only Linux tells what a process listens to")
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_signals_end_a_scripted_run(begin, tmp_path, number):
    lines = [
        json.dumps({"do": "state", "file": f"{tmp_path}/begun.json"}),
        '{"do":"wait","frames":1000000000}',
    ]
    (tmp_path / "events.jsonl").write_text("\n".join(lines))
    app = begin("--offscreen", "--replay", str(tmp_path / "events.jsonl"))
    until((tmp_path / "begun.json").exists)
    app.send_signal(number)
    assert app.wait(60) == TERMINATED
    assert app.stderr.read() == "terminated\n"


@pytest.mark.gl
@pytest.mark.usefixtures("software_gl")
@pytest.mark.skipif(sys.platform != "linux", reason="only Linux tells what a process listens to")
def test_sigterm_ends_the_measurements(begin):
    app = begin("--bench")
    until(lambda: app.poll() is not None or listens(app.pid))
    app.terminate()
    assert app.wait(60) == TERMINATED
    assert app.stderr.read() == "terminated\n"
