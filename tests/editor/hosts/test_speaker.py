"""Sounds are made, and a machine without audio is silent, which is said."""

import numpy as np
import pygame
import pytest

from editor.hosts.speaker import RATE, Speaker, waves
from editor.play.cues import Cue


def test_sounds_are_short_and_neither_silent_nor_too_loud():
    for name, wave in waves().items():
        assert wave.dtype == np.int16
        assert 0.05 * RATE < len(wave) < 1.2 * RATE, name
        assert 8_000 < np.abs(wave.astype(int)).max() < 20_000
        assert abs(wave.astype(float).mean()) < 200


def test_it_plays_where_there_is_a_device(monkeypatch):
    monkeypatch.setenv("SDL_AUDIODRIVER", "dummy")
    speaker = Speaker()
    speaker.play([Cue(name="hit", loudness=0.5), Cue(name="won")], 0.6)
    assert speaker.fault == ""
    assert pygame.mixer.get_busy()
    speaker.close()
    assert pygame.mixer.get_init() is None


@pytest.mark.parametrize("driver", ["nonsense", "disk-that-is-not-there"])
def test_without_a_device_it_is_silent_and_says_so_once(monkeypatch, driver):
    monkeypatch.setenv("SDL_AUDIODRIVER", driver)
    speaker = Speaker()
    for _ in range(3):
        speaker.play([Cue(name="hit")], 1.0)
    assert speaker.fault.startswith("No sound: ")
    speaker.close()


def test_nothing_is_opened_before_something_is_heard():
    speaker = Speaker()
    speaker.play([], 1.0)
    assert pygame.mixer.get_init() is None
