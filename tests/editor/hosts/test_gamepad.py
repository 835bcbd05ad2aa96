"""Events of a gamepad, as pygame gives them, drive what the keys drive."""

import pygame
import pytest

from editor import actions
from editor.base.events import PadEvent
from editor.hosts.gamepad import Gamepads
from editor.play.mode import Mode
from tests.editor.core.helpers import a_session


@pytest.fixture
def pads():
    return Gamepads()


def axis(which, share):
    return pygame.event.Event(pygame.CONTROLLERAXISMOTION, axis=which, value=round(32767 * share))


def button(which, down):
    kind = pygame.CONTROLLERBUTTONDOWN if down else pygame.CONTROLLERBUTTONUP
    return pygame.event.Event(kind, button=which)


def names(found):
    return [(event.control, event.pressed) for event in found]


def test_a_stick_has_a_dead_zone_and_does_not_flutter(pads):
    x = pygame.CONTROLLER_AXIS_LEFTX
    assert names(pads.translate(axis(x, -0.3))) == []
    assert names(pads.translate(axis(x, -0.6))) == [("pad left", True)]
    assert names(pads.translate(axis(x, -0.45))) == []
    assert names(pads.translate(axis(x, -0.9))) == []
    assert names(pads.translate(axis(x, 0.8))) == [("pad left", False), ("pad right", True)]
    assert names(pads.translate(axis(x, 0.0))) == [("pad right", False)]


def test_a_resting_stick_leaves_the_cross_alone(pads):
    x, left = pygame.CONTROLLER_AXIS_LEFTX, pygame.CONTROLLER_BUTTON_DPAD_LEFT
    assert names(pads.translate(button(left, True))) == [("pad left", True)]
    assert names(pads.translate(axis(x, 0.01))) == []
    assert names(pads.translate(axis(x, -1.0))) == []
    assert names(pads.translate(button(left, False))) == []
    assert names(pads.translate(axis(x, 0.0))) == [("pad left", False)]


def test_a_pad_that_is_pulled_out_leaves_the_other_one_its_buttons(pads):
    for pad in (0, 1):
        pressed = pygame.event.Event(
            pygame.CONTROLLERBUTTONDOWN, button=pygame.CONTROLLER_BUTTON_A, instance_id=pad
        )
        pads.translate(pressed)
    gone = [pygame.event.Event(pygame.CONTROLLERDEVICEREMOVED, instance_id=pad) for pad in (0, 1)]
    assert names(pads.translate(gone[0])) == []
    assert names(pads.translate(gone[1])) == [("pad a", False)]


def test_a_pad_that_is_pulled_out_holds_nothing(pads):
    pads.translate(button(pygame.CONTROLLER_BUTTON_A, True))
    gone = pygame.event.Event(pygame.CONTROLLERDEVICEREMOVED, instance_id=0)
    assert names(pads.translate(gone)) == [("pad a", False)]


def test_a_pad_that_cannot_be_opened_is_left_alone(pads):
    added = pygame.event.Event(pygame.CONTROLLERDEVICEADDED, device_index=1000)
    assert pads.translate(added) == []


def test_other_events_mean_nothing(pads):
    assert pads.translate(pygame.event.Event(pygame.KEYDOWN, key=1)) == []
    assert pads.translate(axis(pygame.CONTROLLER_AXIS_TRIGGERLEFT, 1.0)) == []


def test_it_drives_and_plays(pads):
    session = a_session()

    def press(*raw):
        for one in raw:
            for event in pads.translate(one):
                actions.handle(session, event)

    press(axis(pygame.CONTROLLER_AXIS_LEFTY, -1.0))
    assert session.mode is Mode.EDIT, "a stick alone must not start Play"
    press(button(pygame.CONTROLLER_BUTTON_START, True))
    press(button(pygame.CONTROLLER_BUTTON_A, True), axis(pygame.CONTROLLER_AXIS_RIGHTX, 1.0))
    assert session.mode is Mode.PLAYING
    assert session.action == (0, 1, 0, 2, 1, 0)
    press(button(pygame.CONTROLLER_BUTTON_A, False))
    assert session.action == (0, 1, 0, 2, 0, 0)
    press(
        button(pygame.CONTROLLER_BUTTON_START, False), button(pygame.CONTROLLER_BUTTON_START, True)
    )
    assert session.mode is Mode.PAUSED
    press(button(pygame.CONTROLLER_BUTTON_BACK, True))
    assert session.mode is Mode.EDIT
    session.release_all()
    assert session.action == (0,) * 6


def test_the_gallery_is_left_alone(monkeypatch):
    session = a_session()
    session.gallery.open = True
    actions.handle(session, PadEvent(control="pad start", pressed=True))
    assert session.mode is Mode.EDIT
