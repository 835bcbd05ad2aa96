"""Levels, episodes and comparisons from files and addresses."""

import contextlib
import errno
import functools
import http.server
import json
import threading
import time

import pytest

from editor.actions.files import address
from editor.agents.evaluation import Evaluation
from editor.base.settings import Settings
from editor.session import Session
from kinetix.agents.compare import Contender
from kinetix.agents.comparison_files import text_of
from kinetix.agents.results import EpisodeResult, LevelResult, Provenance
from kinetix.files.address import fetch, is_address, name_of
from kinetix.files.regular import FileError
from kinetix.level.codec import dumps, level_hash, load_level


@pytest.fixture
def web(tmp_path):
    """A server of a folder; gives its address."""

    class Quiet(http.server.SimpleHTTPRequestHandler):
        def log_message(self, *_):
            pass

        def do_GET(self):
            if self.path == "/elsewhere.json":
                self.send_response(302)
                self.send_header("Location", "file:///etc/passwd")
                self.end_headers()
            elif self.path == "/short.json":
                self.send_response(200)
                self.send_header("Content-Length", "100")
                self.end_headers()
                self.wfile.write(b"{}")
            elif self.path == "/chunked.json":
                self.wfile.write(b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n5\r\n{")
            elif self.path == "/header.json":
                self.wfile.write(b"HTTP/1.1 200 OK\r\nX: ")
                with contextlib.suppress(OSError):
                    for _ in range(300):
                        self.wfile.write(b"x")
                        time.sleep(0.01)
            elif self.path == "/endless.json":
                self.send_response(200)
                self.end_headers()
                with contextlib.suppress(OSError):
                    while True:
                        self.wfile.write(b" ")
                        time.sleep(0.01)
            else:
                super().do_GET()

    handler = functools.partial(Quiet, directory=str(tmp_path))
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}"
    server.shutdown()
    server.server_close()


def test_what_breaks_off_or_never_ends_is_refused(web, monkeypatch):
    with pytest.raises(FileError, match="broke off after 2 of 100 bytes; try again"):
        fetch(f"{web}/short.json", "level")
    with pytest.raises(FileError, match=r"chunked\.json: broke off; try again"):
        fetch(f"{web}/chunked.json", "level")
    monkeypatch.setattr("kinetix.files.address.LONGEST_SECONDS", 0.1)
    for name in ("endless", "header"):
        with pytest.raises(FileError, match="too slow"):
            fetch(f"{web}/{name}.json", "level")


def _take(session):
    until = time.monotonic() + 30
    while session.fetches.waiting and time.monotonic() < until:
        session.fetches.poll()
        time.sleep(0.01)


def _comparison(level):
    episodes = [
        EpisodeResult(outcome=outcome, total_reward=0.5, length=9) for outcome in ("won", "lost")
    ]
    whence = Provenance(
        agent="random", digest="", physics="balanced", seed=3, attempts=2, deterministic=False
    )
    contender = Contender(
        label="random", provenance=whence, results=(LevelResult.of("s/goalkeeper", episodes),)
    )
    return text_of(".json", [contender], {"s/goalkeeper": level_hash(level)}, "1")


def test_a_level_is_opened_from_an_address(web, tmp_path):
    level = load_level("s/goalkeeper")
    (tmp_path / "mine.json").write_text(dumps(level))
    session = Session(settings=Settings())
    assert address.open_any(session, f"{web}/mine.json")
    _take(session)
    assert session.document.level == level and session.document.path is None
    assert session.document.dirty  # no file here has it


def test_what_cannot_be_fetched_is_one_sentence(web, tmp_path):
    (tmp_path / "bad.json").write_text("{}")
    session = Session(settings=Settings())
    before = session.document
    for name in ("missing.json", "bad.json", "elsewhere.json"):
        address.open_address(session, f"{web}/{name}")
        _take(session)
        assert session.prompts and session.document is before
        session.prompts.clear()
    address.open_address(session, "ftp://example.org/level.json")
    assert session.prompts


def test_what_cannot_be_kept_aside_is_one_sentence(web, tmp_path, monkeypatch):
    (tmp_path / "mine.json").write_text(dumps(load_level("s/goalkeeper")))
    session = Session(settings=Settings())

    def missing():
        raise FileNotFoundError(errno.ENOENT, "No usable temporary directory found")

    monkeypatch.setattr("editor.actions.files.address.tempfile.TemporaryDirectory", missing)
    address.open_address(session, f"{web}/mine.json")
    _take(session)
    (prompt,) = session.prompts
    assert prompt.title == "This cannot be opened"
    assert prompt.message.endswith("a temporary folder: No usable temporary directory found")


def test_a_place_may_be_written_as_people_write_it(web, tmp_path):
    (tmp_path / "grüne Kugel.json").write_text("{}")
    for end in ("grüne Kugel.json", "gr%C3%BCne%20Kugel.json"):
        assert fetch(f"{web}/{end}", "level") == b"{}"
    with pytest.raises(FileError):
        fetch("http://grüne kugel.invalid/a.json", "level")


def test_addresses_are_only_those_of_the_web(web):
    assert is_address("https://example.org/a.json") and not is_address("/tmp/a.json")
    assert not is_address("file:///etc/passwd") and not is_address("https://")
    assert name_of("https://example.org/a%20b.json?x=1") == "a b.json"
    assert name_of("https://example.org/") == "file"
    with pytest.raises(FileError, match="not allowed"):
        fetch(f"{web}/elsewhere.json", "level")


@pytest.mark.parametrize(
    ("end", "name"),
    [
        ("a" * 300 + ".json", "a" * 40 + ".json"),
        ("lev%00el.json", "level.json"),
        ("a.json/..", "file"),
        ("..%5Ca.json", "a.json"),
        (".json", "json"),
        ("%E8%BB%8A" * 100 + ".npz", "車" * 40 + ".npz"),
        ("a." + "b" * 300, "a.bbbbbbbbb"),
    ],
)
def test_an_address_may_end_in_what_no_file_can_be_called(monkeypatch, end, name):
    level = load_level("s/goalkeeper")
    monkeypatch.setattr(address, "fetch", lambda *_: dumps(level).encode())
    session = Session(settings=Settings())
    assert name_of(f"https://example.org/{end}") == name
    address.open_address(session, f"https://example.org/{end}")
    _take(session)
    assert session.document.level == level


def test_a_comparison_takes_the_place_of_a_running_evaluation_only_after_a_question(
    tmp_path, monkeypatch
):
    path = tmp_path / "compared.json"
    path.write_text(_comparison(load_level("s/goalkeeper")))
    session = Session(settings=Settings())
    monkeypatch.setattr(Evaluation, "running", True)
    for choice in ("cancel", "stop"):
        assert address.open_any(session, str(path))
        assert session.viewer.evaluation.plan is None
        session.answer(session.prompts[-1], choice)
    assert session.viewer.evaluation.plan is not None


def test_a_stored_comparison_is_a_table_again(tmp_path):
    """Rates, provenance and a second save are those of the file."""
    level = load_level("s/goalkeeper")
    path = tmp_path / "compared.json"
    path.write_text(_comparison(level))
    session = Session(settings=Settings())
    assert address.open_any(session, str(path))
    evaluation = session.viewer.evaluation
    (row,) = evaluation.rows()
    assert row.results[0].solve_rate == 0.5 and row.results[0].attempts == 2
    assert evaluation.plan.levels[0].source == "s/goalkeeper"
    again = json.loads(evaluation.comparison_text(".json"))
    first = json.loads(path.read_text())
    for name in ("levels", "leaderboard", "differences", "policies"):
        assert again[name] == first[name]
