"""The hosts: windows, clocks and input for the one frame function of `editor.window.ui`."""

import os

# pygame greets on stdout when it is imported, which would spoil what the commands print there.
os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
# Sound is never used; without this SDL complains on machines that have none.
os.environ.setdefault("SDL_AUDIODRIVER", "dummy")
# What desktops group our windows by; SDL reads it when pygame is imported.
os.environ.setdefault("SDL_VIDEO_X11_WMCLASS", "kinetix-editor")
