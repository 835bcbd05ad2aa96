"""The hosts: windows, clocks and input for the one frame function of `editor.ui`."""

import os

# pygame greets on stdout when it is imported, which would spoil what the commands print there.
os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
