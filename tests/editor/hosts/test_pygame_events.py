"""Every event of pygame that matters becomes ours, and nothing else does."""

import pygame
import pytest
from imgui_bundle import imgui

from editor.base.events import (
    DropEvent,
    FocusEvent,
    KeyEvent,
    Modifiers,
    PinchEvent,
    Pointer,
    PointerEvent,
    QuitEvent,
    TextEvent,
    WheelEvent,
)
from editor.base.settings import USUAL_SIZE
from editor.documents.commands.bodies import AddBody
from editor.hosts.inputs import FAR, InputFeeder
from editor.hosts.pygame_events import translate
from editor.hosts.pygame_host import fitting
from editor.session import Session
from editor.toolkit.keys import IMGUI, label
from kinetix.level.model import Body, Circle, Level
from tests.editor.gui.conftest import Gui


@pytest.fixture(autouse=True)
def key_names(monkeypatch):
    # pygame knows the names of keys only while its display module is up.
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    pygame.display.init()
    yield
    pygame.display.quit()


@pytest.fixture
def gui():
    gui = Gui(Session(level=Level(name="Empty")))
    yield gui
    gui.host.close()


def event(kind: int, **values: object) -> pygame.event.Event:
    return pygame.event.Event(kind, **values)


@pytest.mark.parametrize(
    ("code", "name"),
    [
        (pygame.K_s, "s"),
        (pygame.K_7, "7"),
        (pygame.K_F5, "f5"),
        (pygame.K_SPACE, "space"),
        (pygame.K_LEFTBRACKET, "["),
        (pygame.K_KP_ENTER, "enter"),
        (pygame.K_LCTRL, "left ctrl"),
        (pygame.K_PAGEDOWN, "page down"),
    ],
)
def test_keys_carry_their_names(code, name):
    ours = translate(event(pygame.KEYDOWN, key=code, mod=pygame.KMOD_LCTRL))
    assert ours == KeyEvent(key=name, pressed=True, modifiers=Modifiers(ctrl=True))
    assert name in IMGUI


@pytest.mark.parametrize(
    ("letter", "place", "name"),
    [
        ("ö", pygame.KSCAN_SEMICOLON, ";"),
        ("ü", pygame.KSCAN_LEFTBRACKET, "["),
        ("ß", pygame.KSCAN_MINUS, "-"),
        ("&", pygame.KSCAN_1, "1"),
        ("z", pygame.KSCAN_Y, "z"),
        ("м", pygame.KSCAN_V, "v"),
        ("ζ", pygame.KSCAN_Z, "z"),
    ],
)
def test_what_other_layouts_have_counts_by_its_place(letter, place, name):
    ours = translate(event(pygame.KEYDOWN, key=ord(letter), scancode=place, mod=0))
    assert ours == KeyEvent(key=name, pressed=True, modifiers=Modifiers())


def test_every_key_of_a_keyboard_is_known_to_imgui():
    codes = [pygame.K_a + k for k in range(26)] + [pygame.K_0 + k for k in range(10)]
    codes += [pygame.K_F1 + k for k in range(12)]
    assert all(pygame.key.name(code) in IMGUI for code in codes)


@pytest.mark.parametrize(("code", "expected"), [(1, 0), (2, 2), (3, 1), (6, 3), (7, 4), (4, None)])
def test_buttons_reach_imgui_and_wheel_twins_do_not(code, expected):
    context = imgui.create_context()
    io = imgui.get_io()
    io.set_ini_filename("")
    io.display_size, io.delta_time = imgui.ImVec2(100, 100), 1 / 60
    io.backend_flags |= imgui.BackendFlags_.renderer_has_textures.value
    ours = translate(event(pygame.MOUSEBUTTONDOWN, button=code, pos=(5, 6)))
    assert isinstance(ours, PointerEvent) and ours.kind is Pointer.PRESS
    InputFeeder().feed([ours])
    imgui.new_frame()
    down = [button for button in range(5) if imgui.is_mouse_down(button)]
    imgui.end_frame()
    imgui.destroy_context(context)
    assert down == ([] if expected is None else [expected])


def test_a_slow_frame_keeps_each_key_with_the_modifiers_that_it_was_pressed_with(gui):
    """Ctrl+Z, then Ctrl+Y and the release of Z and Ctrl in one frame."""
    session = gui.session
    session.execute(AddBody(body=Body(id=1, shape=Circle(radius=0.2), position=(2.0, 2.0))))
    gui.hold("left ctrl")
    gui.hold("z")
    gui.frames(2)
    assert not session.document.level.bodies
    strokes = (("y", True), ("z", False), ("left ctrl", False), ("y", False))
    gui.host.frames(3, *(KeyEvent(key=key, pressed=down) for key, down in strokes))
    assert len(session.document.level.bodies) == 1


def test_the_rest():
    assert translate(
        event(pygame.MOUSEWHEEL, x=0, y=1, precise_x=0.0, precise_y=1.5)
    ) == WheelEvent(dy=1.5, dx=-0.0)
    assert translate(event(pygame.TEXTINPUT, text="é")) == TextEvent(text="é")
    assert translate(event(pygame.WINDOWFOCUSLOST)) == FocusEvent(focused=False)
    assert translate(event(pygame.DROPFILE, file="a.json")) == DropEvent(path="a.json")
    assert translate(event(pygame.QUIT)) == QuitEvent()
    left = translate(event(pygame.WINDOWLEAVE))
    assert isinstance(left, PointerEvent) and left.screen == FAR
    assert translate(event(pygame.AUDIODEVICEADDED, which=0, iscapture=0)) is None


@pytest.mark.parametrize(
    ("chord", "words"),
    [("ctrl+shift+z", "Ctrl+Shift+Z"), ("space", "Space"), ("page up", "PgUp"), ("[", "[")],
)
def test_chords_for_people(chord, words):
    assert label(chord) == words


def test_two_fingers_that_move_apart_zoom_where_they_are(monkeypatch):
    monkeypatch.setattr(pygame.display, "get_window_size", lambda: (800, 600))
    values = {"touch_id": 1, "rotated": 0.0, "x": 0.25, "y": 0.5}
    apart = translate(event(pygame.MULTIGESTURE, num_fingers=2, pinched=0.1, **values))
    assert isinstance(apart, PinchEvent)
    assert apart.screen == (200, 300) and 1.2 < apart.factor < 1.4
    closer = translate(event(pygame.MULTIGESTURE, num_fingers=2, pinched=-0.1, **values))
    assert closer.factor == pytest.approx(1 / apart.factor)
    assert translate(event(pygame.MULTIGESTURE, num_fingers=3, pinched=0.1, **values)) is None
    assert translate(event(pygame.MULTIGESTURE, num_fingers=2, pinched=0.0, **values)) is None


@pytest.mark.parametrize("size", [USUAL_SIZE, (2500, 300), (900, 1400)])
@pytest.mark.parametrize("screen", [(1366, 768), (1280, 800), (1440, 900), (3840, 2160)])
def test_a_window_of_no_told_size_is_all_on_the_screen(size, screen):
    window = fitting(size, screen)
    assert all(side < most for side, most in zip(window, screen, strict=True))
    assert all(side <= most for side, most in zip(window, size, strict=True))
    assert fitting(size, (8000, 8000)) == size
