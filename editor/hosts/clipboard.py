"""The system's clipboard behind Dear ImGui's; a private one where there is none."""

import pygame
from imgui_bundle import imgui

_TEXT = "text/plain;charset=utf-8"


class Clipboard:
    """Text in and out; what this app put there is remembered in case the system forgets it."""

    def __init__(self) -> None:
        self._own = ""
        self._system = False
        try:
            pygame.scrap.init()
            self._system = pygame.scrap.get_init()
        except pygame.error:
            self._system = False

    def get(self) -> str:
        """Return the content of the clipboard, or nothing."""
        if not self._system:
            return self._own
        data = pygame.scrap.get(_TEXT) if pygame.scrap.contains(_TEXT) else None
        if data:
            return data.decode("utf-8", "replace").rstrip("\0")
        # Of other programs there are texts that do not arrive, such as very long ones.
        return "" if pygame.scrap.lost() else self._own

    def set(self, text: str) -> None:
        """Put text on the clipboard."""
        self._own = text
        if self._system:
            pygame.scrap.put(_TEXT, text.encode())

    def install(self) -> None:
        """Make Dear ImGui's text fields use it."""
        platform = imgui.get_platform_io()
        platform.platform_get_clipboard_text_fn = lambda context: self.get()
        platform.platform_set_clipboard_text_fn = lambda context, text: self.set(text)
