"""The same app without a display: SDL's offscreen driver and OpenGL in software."""

import os

from editor.hosts.pygame_host import PygameHost
from editor.hosts.renderer import GlRenderer, Window
from editor.session import Session

ENVIRONMENT = {
    "SDL_VIDEODRIVER": "offscreen",
    "SDL_AUDIODRIVER": "dummy",
    "LIBGL_ALWAYS_SOFTWARE": "1",
    # One thread of the software rasteriser: pictures are the same everywhere, JAX keeps its cores.
    "LP_NUM_THREADS": "1",
}
"""Environment variables that must be set before the window opens."""


class OffscreenHost(PygameHost):
    """Draws into memory; nothing waits for a display."""

    needs_display = False

    def __init__(
        self, session: Session, *, size: tuple[int, int] = (1440, 900), scale: float = 1.0
    ) -> None:
        os.environ.update(ENVIRONMENT)
        super().__init__(session, size=size, scale=scale, vsync=False)

    def _make_renderer(self) -> GlRenderer:
        self._pictures = GlRenderer(Window.LASTS)
        return self._pictures

    def resize(self, size: tuple[int, int]) -> bool:
        """Change the size of the window, as `Host.resize` does."""
        self.size = size
        self._pictures.leave_window()
        return True
