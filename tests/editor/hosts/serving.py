"""The served app as a process, and what a page does with it."""

import contextlib
import http.client
import json
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from tests.editor.hosts.processes import end, start


class Served:
    """`kinetix-editor --serve`, and its address."""

    def __init__(self, home: dict[str, str], ends: contextlib.ExitStack, *words: str) -> None:
        self.ends = ends
        self.app = start(
            [sys.executable, "-m", "editor", "--serve", "--port", "0", *words],
            env=home | {"PYTHONUNBUFFERED": "1"},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
        ends.callback(end, self.app)
        assert self.app.stdout is not None
        ends.callback(self.app.stdout.close)
        line = self.app.stdout.readline()
        found = re.search(r"http://\S+", line)
        assert found, f"no address in {line!r}"
        self.url = found[0]
        parts = urlsplit(self.url)
        self.host, self.port, self.path = parts.hostname or "", parts.port or 0, parts.path

    def request(self, method: str, path: str, body: Any = None) -> tuple[int, str]:
        """Ask once; returns the status and the text."""
        connection = http.client.HTTPConnection(self.host, self.port, timeout=30)
        try:
            said = None if body is None else json.dumps(body)
            connection.request(method, path, said)
            answer = connection.getresponse()
            return answer.status, answer.read().decode()
        finally:
            connection.close()

    def say(self, viewer: str, *messages: list) -> tuple[int, str]:
        """Say something as a page does."""
        return self.request("POST", f"{self.path}input?viewer={viewer}", list(messages))

    def stop(self) -> int:
        """End it as Ctrl+C does; returns the exit status."""
        self.app.send_signal(signal.SIGINT)
        return self.app.wait(30)


def eventually(true: Callable[[], Any], seconds: float = 30.0) -> Any:
    """Wait until something holds; returns it."""
    ends = time.monotonic() + seconds
    while not (found := true()):
        assert time.monotonic() < ends, "it never came true"
        time.sleep(0.05)
    return found


def bodies(path: Path) -> int:
    """Return how many bodies a level's file has."""
    return len(json.loads(path.read_text())["bodies"])
