"""Messages to a page and from it, without a page."""

import http.client
import io
import json
import struct
import threading
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from editor.base import events
from editor.hosts.web import messages
from editor.hosts.web.outlet import Outlet
from editor.hosts.web.regions import changes, encoded
from editor.hosts.web.server import PageServer
from kinetix.errors import KinetixError


def noise(height: int, width: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).integers(0, 256, (height, width, 3), dtype=np.uint8)


class Page:
    """Takes an outlet's packets as the page's script does."""

    def __init__(self, outlet: Outlet) -> None:
        self.outlet = outlet
        self.picture = np.zeros((1, 1, 3), np.uint8)
        self.told: dict = {}
        self.frames: list[dict] = []
        self.connection = outlet.attach()
        self._packets = outlet.packets(self.connection)

    def take(self) -> dict:
        data = next(self._packets)
        assert struct.unpack(">I", data[:4])[0] == len(data) - 4
        length = struct.unpack(">I", data[4:8])[0]
        header, at = json.loads(data[8 : 8 + length]), 8 + length
        if "frame" not in header:
            self.told |= header
            return header
        width, height = header["size"]
        if self.picture.shape[:2] != (height, width):
            self.picture = np.zeros((height, width, 3), np.uint8)
        for left, top, right, bottom, size in header["regions"]:
            part = Image.open(io.BytesIO(data[at : at + size]))
            self.picture[top:bottom, left:right] = np.asarray(part.convert("RGB"))
            at += size
        assert at == len(data)
        self.frames.append(header)
        return header

    def draw(self) -> dict:
        header = self.take()
        self.outlet.drawn(header["frame"])
        return header


@pytest.fixture
def outlet():
    return Outlet(lambda: None)


@settings(deadline=None)
@given(
    size=st.tuples(st.integers(1, 150), st.integers(1, 150)),
    places=st.lists(st.tuples(st.integers(0, 149), st.integers(0, 149)), max_size=6),
)
def test_the_boxes_cover_every_change_and_do_not_overlap(size, places):
    before = noise(*size)
    after = before.copy()
    for y, x in places:
        after[y % size[0], x % size[1]] ^= 255
    boxes = changes(before, after)
    covered = np.zeros(size, int)
    for left, top, right, bottom in boxes:
        covered[top:bottom, left:right] += 1
    assert covered.max(initial=0) <= 1
    assert (covered[(before != after).any(axis=2)] == 1).all()
    assert bool(boxes) == bool((before != after).any())


def test_another_size_is_a_change_everywhere():
    assert changes(noise(10, 20), noise(20, 10)) == [(0, 0, 10, 20)]
    assert changes(None, noise(20, 10)) == [(0, 0, 10, 20)]


def test_small_changes_arrive_exactly(outlet):
    page = Page(outlet)
    first = noise(120, 200)
    outlet.show(first)
    assert page.draw()["kind"] == "image/png"
    np.testing.assert_array_equal(page.picture, first)
    second = first.copy()
    second[40:50, 60:70] = 7
    outlet.show(second)
    header = page.draw()
    np.testing.assert_array_equal(page.picture, second)
    sent = sum((r - l) * (b - t) for l, t, r, b, _ in header["regions"])
    assert sent < 200 * 120 / 4


def test_large_changes_arrive_soon_and_exactly_once_they_rest(outlet):
    page = Page(outlet)
    picture = np.kron(noise(12, 16), np.ones((40, 40, 1), np.uint8))
    outlet.show(picture)
    assert page.draw()["kind"] == "image/jpeg"
    while not np.array_equal(page.picture, picture):
        assert page.draw()["kind"] == "image/png"
        assert len(page.frames) < 20
    assert page.take() == {}  # then there is silence


def test_a_smaller_page_is_not_refined_beyond_its_edge(outlet):
    page = Page(outlet)
    outlet.show(noise(400, 400))
    page.draw()
    small = noise(100, 100, 1)
    outlet.show(small)
    page.draw()
    np.testing.assert_array_equal(page.picture, small)
    assert page.take() == {}


def test_a_page_that_does_not_draw_gets_no_more_than_two(outlet):
    page = Page(outlet)
    for seed in range(2):
        assert outlet.wanted
        outlet.show(noise(40, 40, seed))
        page.take()
    assert not outlet.wanted
    outlet.drawn(page.frames[0]["frame"])
    assert outlet.wanted


def test_a_newer_picture_takes_the_place_of_one_that_waits(outlet):
    page = Page(outlet)
    outlet.show(noise(40, 40, 1))
    outlet.show(noise(40, 40, 2))
    page.draw()
    np.testing.assert_array_equal(page.picture, noise(40, 40, 2))


def test_nobody_looks_nothing_is_wanted(outlet):
    assert not outlet.wanted
    connection = outlet.attach()
    assert outlet.wanted and outlet.fresh
    assert outlet.detach(connection)
    assert not outlet.wanted


def test_a_page_that_comes_later_learns_what_lasts(outlet):
    outlet.tell("title", "One")
    outlet.tell("clipboard", "secret", lasting=False)
    outlet.tell("title", "Two")
    page = Page(outlet)
    assert page.take() == {"title": "Two"}


def test_what_is_told_goes_out_before_the_end(outlet):
    page = Page(outlet)
    outlet.tell("ended", True)
    ending = threading.Thread(target=outlet.finish)
    ending.start()
    assert page.take() == {"ended": True}
    with pytest.raises(StopIteration):
        page.take()
    assert ending.is_alive()  # what is taken may not be written yet
    outlet.detach(page.connection)
    ending.join()


def test_the_second_page_ends_the_first_ones_stream(outlet):
    first = Page(outlet)
    second = Page(outlet)
    with pytest.raises(StopIteration):
        first.take()
    outlet.show(noise(10, 10))
    second.draw()


def test_a_page_that_comes_back_before_it_was_missed_holds_nothing(outlet):
    taken: list = []
    server = PageServer(outlet, taken.extend, port=0)
    server.start()
    path = f"/{server.secret}/stream?viewer=one"
    lines = [http.client.HTTPConnection("127.0.0.1", server.port, timeout=30) for _ in range(2)]
    try:
        for line in lines:
            line.request("GET", path)
            assert line.getresponse().status == 200
            assert tuple(taken) == messages.GONE
            taken.clear()
    finally:
        for line in lines:
            line.close()
        server.stop()


@pytest.mark.parametrize(
    ("code", "key", "name"),
    [
        ("KeyZ", "y", "y"),  # a German keyboard
        ("KeyZ", "Z", "z"),
        ("KeyQ", "ä", "q"),
        ("Digit1", "!", "1"),
        ("BracketLeft", "{", "["),
        ("ArrowLeft", "ArrowLeft", "left"),
        ("Enter", "Enter", "return"),
        ("NumpadEnter", "Enter", "enter"),
        ("Numpad4", "ArrowLeft", "[4]"),
        ("ShiftRight", "Shift", "right shift"),
        ("ControlLeft", "Control", "left ctrl"),
        ("MetaLeft", "Meta", "left meta"),
        ("F5", "F5", "f5"),
        ("Space", " ", "space"),
        ("Escape", "Escape", "escape"),
        ("AudioVolumeUp", "AudioVolumeUp", None),
        ("", "", None),
    ],
)
def test_keys_have_pygames_names(code, key, name):
    assert messages.key_name(code, key) == name


def test_all_named_keys_are_known_to_the_app():
    from editor.toolkit import keys

    assert set(messages._NAMES.values()) <= set(keys.IMGUI)


def test_input_is_read():
    said = [["move", 3, 4.5], ["down", 3, 4, 2], ["key", "KeyS", "s", True], ["text", "é"]]
    (move, down, key, text), faults = messages.read(said)
    assert not faults
    assert move.kind is events.Pointer.MOVE and move.screen == (3.0, 4.5)
    assert down.kind is events.Pointer.PRESS and down.button == events.RIGHT
    assert key == events.KeyEvent(key="s", pressed=True)
    assert text == events.TextEvent(text="é")


def test_pictures_are_counted_beyond_the_largest_coordinate():
    (drawn,), _ = messages.read([["drawn", 10**6]])
    assert drawn == messages.Drawn(number=10**6)


@pytest.mark.parametrize(
    "said",
    [
        [1],
        [[]],
        [["move", 1]],
        [["move", "a", "b"]],
        [["move", float("nan"), 0]],
        [["move", 10**400, 0]],
        [["move", 1, 2, 3]],
        [["eval", "1"]],
        [[["move"], 1, 2]],
        [["key", "KeyA", "a", "yes"]],
        [["text", 5]],
        [["text", "a" * (messages.LONGEST + 1)]],
        [["size", True, 1, 1]],
        [["drawn", -1]],
        [["drawn", 1.5]],
    ],
)
def test_junk_is_refused_with_a_sentence_and_the_rest_is_taken(said):
    release = ["key", "KeyV", "v", False]
    taken, faults = messages.read([*said, release])
    assert taken == [events.KeyEvent(key="v", pressed=False)]
    assert [str(fault)[:7] for fault in faults] == ["input: "]


@pytest.mark.parametrize("said", [None, {"move": 1}, 5])
def test_what_is_no_list_of_messages_is_refused(said):
    with pytest.raises(KinetixError, match="input: expected a list"):
        messages.read(said)


def test_the_page_knows_how_long_a_text_may_be():
    page = Path(messages.__file__).with_name("page.html").read_text(encoding="utf-8")
    assert f"LONGEST = {messages.LONGEST};" in page


def test_encoded_parts_are_cut_where_asked():
    picture = noise(30, 40)
    part = Image.open(io.BytesIO(encoded(picture, (5, 10, 25, 20), "image/png")))
    np.testing.assert_array_equal(np.asarray(part), picture[10:20, 5:25])
