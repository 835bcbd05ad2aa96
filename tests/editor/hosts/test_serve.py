"""The served app by HTTP: its secret, its one user, its end."""

import contextlib
import http.client
import json
import signal
import socket
import struct
import subprocess
import sys
import time

import pytest

from kinetix.level.codec import save_level
from kinetix.level.model import Level
from tests.editor import days
from tests.editor.hosts.serving import Served, bodies, eventually

pytestmark = [pytest.mark.gl, pytest.mark.usefixtures("software_gl")]


@pytest.fixture
def ends():
    with contextlib.ExitStack() as stack:
        yield stack


@pytest.fixture
def level(tmp_path):
    path = tmp_path / "drawn.json"
    save_level(Level(name="Drawn"), path)
    return path


@pytest.fixture
def day(request, tmp_path):
    """The first day, or the second where a test asks for it: the state of yesterday is there."""
    day = getattr(request, "param", days.FIRST)
    if day == days.SECOND:
        days.put(request.getfixturevalue("yesterday"), tmp_path)
    return day


@pytest.fixture
def served(home, ends, level, day):
    del day
    return Served(home, ends, "--scale", "1", str(level))


class Stream:
    """The pictures' connection of one page, unread but for what is asked for."""

    def __init__(self, served: Served, viewer: str) -> None:
        served.ends.callback(self.close)
        self.served, self.viewer = served, viewer
        self.connection = http.client.HTTPConnection(served.host, served.port, timeout=30)
        self.connection.request("GET", f"{served.path}stream?viewer={viewer}")
        self.answer = self.connection.getresponse()

    def shows(self, size: list[int]) -> None:
        """Draw what comes, as a page does, until a second picture of that size or a still one."""
        pictures = 0
        while pictures < 2:
            length = struct.unpack(">I", self.answer.read(4))[0]
            body = self.answer.read(length)
            header = json.loads(body[4 : 4 + struct.unpack(">I", body[:4])[0]])
            if "frame" in header:
                self.served.say(self.viewer, ["drawn", header["frame"]])
                pictures += header["size"] == size
            elif not header and pictures:
                return

    def close(self) -> None:
        # The answer's file keeps the socket open.
        self.answer.close()
        self.connection.close()


def test_who_lacks_the_secret_gets_nothing(served):
    for path in ("/", "/page.html", f"/wrong{served.path}", served.path[:-3] + "/", "/%00/", "/é/"):
        status, text = served.request("GET", path.replace("é", "%C3%A9"))
        assert status == 404 and "whole address" in text and "canvas" not in text
    status, _ = served.request("POST", "/wrong/input?viewer=a", [])
    assert status == 404
    assert served.request("GET", served.path[:-1])[0] == 308  # a link that lost its last slash
    status, text = served.request("GET", served.path)
    assert status == 200 and "<canvas" in text
    assert "http" not in text.replace("http://www.w3.org/2000/svg", "").replace("https ", "")


def test_it_listens_on_this_machine_only(served):
    assert served.host == "127.0.0.1"
    own = socket.gethostbyname(socket.gethostname())
    if not own.startswith("127."):
        with pytest.raises(OSError):
            socket.create_connection((own, served.port), timeout=2).close()


def test_one_user_at_a_time(served):
    first = Stream(served, "one")
    assert first.answer.status == 200
    second = Stream(served, "two")
    assert second.answer.status == 409
    sentence = second.answer.read().decode().strip()
    assert "open in another page" in sentence and "\n" not in sentence
    status, _ = served.say("two", ["key", "KeyC", "c", True])
    assert status == 409
    first.close()
    third = Stream(served, "two")
    assert third.answer.status == 200


@pytest.mark.parametrize("day", days.DAYS, indirect=True)
def test_input_draws_and_a_later_page_goes_on(served, level, day):
    def draw_and_save(page):
        """Draw a circle and save; a window that is slow may miss one, so it is done again."""
        drag = [["move", 600, 300], ["down", 600, 300, 0], ["move", 640, 300], ["up", 640, 300, 0]]
        control, save = ("ControlLeft", "Control"), ("KeyS", "s")
        keys = ((control, True), (save, True), (save, False), (control, False))
        letter = [["key", "KeyC", "c", down] for down in (True, False)]
        for message in (*letter, *drag, *(["key", *key, down] for key, down in keys)):
            assert served.say(page, message)[0] == 204
            time.sleep(0.1)
        return bodies(level)

    first = Stream(served, "one")
    served.say("one", ["size", 1200, 800, 1.0], ["focus", True])
    first.shows([1200, 800])
    if day == days.SECOND:
        # Yesterday's unsaved work is asked about: not now.
        served.say("one", ["key", "Escape", "Escape", True], ["key", "Escape", "Escape", False])
        time.sleep(0.5)
    eventually(lambda: draw_and_save("one") > 0)
    drawn = bodies(level)
    first.close()
    second = Stream(served, "two")
    assert second.answer.status == 200
    eventually(lambda: draw_and_save("two") > drawn)


@pytest.mark.parametrize("place, status", [("/wrong/input", 404), ("input?viewer=two", 409)])
def test_input_of_who_may_say_nothing_is_not_read(served, place, status):
    Stream(served, "one")
    where = place if place.startswith("/") else served.path + place
    with socket.create_connection((served.host, served.port), timeout=10) as raw:
        raw.sendall(f"POST {where} HTTP/1.1\r\nContent-Length: 9999999\r\n\r\n".encode())
        answer = b""
        while part := raw.recv(4096):
            answer += part
    assert answer.startswith(f"HTTP/1.1 {status} ".encode())


@pytest.mark.parametrize("body", [None, {"a": 1}, [["eval", "1"]], [["move", 1]], 5])
def test_junk_is_refused_and_the_app_goes_on(served, body):
    Stream(served, "one")
    status, text = served.request("POST", f"{served.path}input?viewer=one", body)
    assert status in (400, 413) and text.count("\n") == 1
    assert served.say("one", ["move", 5, 5])[0] == 204


def test_raw_junk_does_not_end_it(served):
    post = b"POST " + served.path.encode() + b"input"
    digits = post + b" HTTP/1.1\r\nContent-Length: " + b"9" * 5000 + b"\r\n\r\n"
    address = b"GET http://[ HTTP/1.1\r\nConnection: close\r\n\r\n"
    for data in (b"\0" * 100, b"GET\r\n\r\n", post + b"\r\n\r\n", digits, address):
        answer = b""
        with socket.create_connection((served.host, served.port), timeout=10) as raw:
            raw.sendall(data)
            raw.shutdown(socket.SHUT_WR)
            while part := raw.recv(4096):
                answer += part
        if b"HTTP/1.1" in data:
            assert answer.startswith(b"HTTP/1.1 4")
    assert served.request("GET", served.path)[0] == 200
    served.stop()
    assert "Traceback" not in served.app.stderr.read()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_it_ends_when_it_is_told_to(served, number):
    stream = Stream(served, "one")
    served.app.send_signal(number)
    assert served.app.wait(30) == 0
    assert b"ended" in stream.answer.read()
    assert served.app.stderr.read() == ""


def run(home, *words):
    return subprocess.run(
        [sys.executable, "-m", "editor", *words],
        env=home,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


_TOLD_AT_A_BAD_MOMENT = """
import signal, sys
from editor.__main__ import main
from editor.hosts.web.host import WebHost

class Last:
    def __del__(self):
        signal.raise_signal(signal.SIGINT)

def follow(host, frames=[]):
    frames.append(1)
    Last() if len(frames) == 3 else None

WebHost._follow = follow
sys.argv = ["kinetix-editor", "--serve", "--port", "0"]
sys.exit(main())
"""


def test_it_ends_when_it_is_told_to_while_exceptions_are_dropped(home):
    """Python drops what is raised in a finaliser, Ctrl+C's exception too."""
    command = [sys.executable, "-c", _TOLD_AT_A_BAD_MOMENT]
    ended = subprocess.run(
        command, env=home, capture_output=True, text=True, timeout=120, check=False
    )
    assert ended.returncode == 0, ended.stderr


_TOLD_WHILE_TRAINING = """
import signal, sys
from editor.__main__ import main
from editor.agents.local_training import LocalTraining
from editor.hosts.web.host import WebHost

stop = LocalTraining.stop
LocalTraining.stop = lambda training: (print("training stopped"), stop(training))
WebHost._follow = lambda host: signal.raise_signal(signal.SIGTERM)
sys.argv = ["kinetix-editor", "--serve", "--port", "0"]
sys.exit(main())
"""


def test_a_training_is_stopped_where_it_is_told_to_end(home):
    command = [sys.executable, "-c", _TOLD_WHILE_TRAINING]
    ended = subprocess.run(
        command, env=home, capture_output=True, text=True, timeout=120, check=False
    )
    assert ended.returncode == 0, ended.stderr
    assert "training stopped" in ended.stdout


def test_a_port_that_is_taken_is_one_sentence(home, served):
    done = run(home, "--serve", "--port", str(served.port))
    assert done.returncode == 1
    assert f"127.0.0.1:{served.port}" in done.stderr and "--port" in done.stderr
    assert done.stderr.count("\n") == 1


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--port", "8000"], "belong to --serve"),
        (["--serve", "--bench"], "leave out"),
        (["--serve", "--port", "70000"], "0 to 65535"),
        (["--serve", "--address", "no.such.host.invalid"], "cannot listen"),
    ],
)
def test_contradictions_are_one_sentence(home, words, sentence):
    done = run(home, *words)
    assert done.returncode == 1
    assert sentence in done.stderr and done.stderr.count("\n") == 1
