"""Sounds of the app, made of sine waves and noise; without an audio device it is silent."""

import contextlib
from typing import Final

import numpy as np
import pygame

from editor.play.cues import Cue, CueName

RATE: Final = 44_100
"""Samples a second."""


def _tone(hertz: float, seconds: float, *, fade: float) -> np.ndarray:
    """Return a sine that dies away; `fade` is the time in which it falls to a third [s]."""
    time = np.arange(round(seconds * RATE)) / RATE
    rise = np.minimum(time / 0.004, 1.0)
    return rise * np.exp(-time / fade) * np.sin(2 * np.pi * hertz * time)


def _tune(notes: tuple[float, ...], step: float) -> np.ndarray:
    """Notes one after the other, each ringing on under the next."""
    ring = 0.45
    out = np.zeros(round((step * len(notes) + ring) * RATE))
    for k, hertz in enumerate(notes):
        start = round(k * step * RATE)
        note = _tone(hertz, ring, fade=0.16) + 0.3 * _tone(2 * hertz, ring, fade=0.08)
        out[start : start + len(note)] += note
    return out


def waves() -> dict[CueName, np.ndarray]:
    """Return every sound as 16-bit samples, one channel, shape (n,)."""
    noise = np.random.default_rng(7).standard_normal(round(0.12 * RATE))
    time = np.arange(len(noise)) / RATE
    thud = _tone(150.0, 0.12, fade=0.03) + 0.25 * noise * np.exp(-time / 0.008)
    shapes: dict[CueName, np.ndarray] = {
        "hit": thud,
        "won": _tune((523.25, 659.26, 783.99, 1046.5), 0.09),
        "lost": _tune((392.0, 329.63, 261.63), 0.14),
        "timeout": _tune((440.0, 440.0), 0.16),
        "broken": _tune((220.0, 207.65), 0.16),
    }
    return {
        name: (0.5 * 32767 * wave / np.abs(wave).max()).astype(np.int16)
        for name, wave in shapes.items()
    }


class Speaker:
    """Plays cues; the audio device is opened for the first one."""

    def __init__(self) -> None:
        self.fault = ""
        """Reason why nothing can be heard; empty while all is well."""
        self._sounds: dict[CueName, pygame.mixer.Sound] = {}

    def play(self, cues: list[Cue], volume: float) -> None:
        """Play some cues.

        Args:
            cues: What to play.
            volume: 0 … 1.
        """
        if not cues or self.fault:
            return
        if not self._sounds:
            self._open()
        for cue in cues:
            sound = self._sounds.get(cue.name)
            if sound is not None:
                sound.set_volume(volume * cue.loudness)
                sound.play()

    def _open(self) -> None:
        try:
            pygame.mixer.init(frequency=RATE, size=-16, channels=1, buffer=512, allowedchanges=0)
            self._sounds = {
                name: pygame.mixer.Sound(buffer=wave.tobytes()) for name, wave in waves().items()
            }
        except (pygame.error, NotImplementedError) as error:
            self.fault = f"No sound: {error}."

    def close(self) -> None:
        """Let go of the audio device."""
        self._sounds = {}
        with contextlib.suppress(pygame.error, NotImplementedError):
            pygame.mixer.quit()
