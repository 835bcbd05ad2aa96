"""Text between the app and other programs, with a clipboard that the test holds."""

import pygame
import pytest

from editor.hosts.clipboard import Clipboard


class System:
    """The system's clipboard; texts that are too long do not arrive."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.text: bytes | None = None
        self.owned = False
        for name, does in {
            "init": lambda: None,
            "get_init": lambda: True,
            "contains": lambda kind: self.text is not None,
            "get": lambda kind: self.text if self.text and len(self.text) < 100 else None,
            "put": lambda kind, text: self.copied(text, owned=True),
            "lost": lambda: not self.owned,
        }.items():
            monkeypatch.setattr(pygame.scrap, name, does)

    def copied(self, text: bytes, *, owned: bool = False) -> None:
        """Somebody copies a text."""
        self.text, self.owned = text, owned


def test_what_others_copied_and_does_not_arrive_is_not_what_the_app_copied(monkeypatch):
    system = System(monkeypatch)
    clipboard = Clipboard()
    clipboard.set("mine")
    assert clipboard.get() == "mine"
    system.copied(b"theirs")
    assert clipboard.get() == "theirs"
    system.copied(b"x" * 1000)
    assert clipboard.get() == ""


def test_what_the_app_copied_is_remembered(monkeypatch):
    long = "x" * 1000
    System(monkeypatch)
    clipboard = Clipboard()
    clipboard.set(long)
    assert clipboard.get() == long
