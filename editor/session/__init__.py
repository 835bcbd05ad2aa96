"""All that the app currently is: see `Session`."""

from editor.session.clipboard import Clipboard, MemoryClipboard
from editor.session.hands import Hands
from editor.session.messages import Kind, Messages, Toast
from editor.session.session import Queued, Session
from editor.session.sound import Sound
from editor.session.tabs import Tab, Tabs
from editor.session.view import View

__all__ = [
    "Clipboard",
    "Hands",
    "Kind",
    "MemoryClipboard",
    "Messages",
    "Queued",
    "Session",
    "Sound",
    "Tab",
    "Tabs",
    "Toast",
    "View",
]
