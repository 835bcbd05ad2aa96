"""Drawing: pure JAX pictures of a world for people, and the pixel observation for agents.

The names are imported on first use: `palette` and `style` must stay usable without JAX.
"""

from typing import TYPE_CHECKING

from kinetix.lazy import lazy_names

if TYPE_CHECKING:
    from kinetix.environment.inverse import make_inverse_render_symbolic
    from kinetix.render.pixels import make_render_pixels, make_render_pixels_rl

_HOME = {
    "make_render_pixels": "kinetix.render.pixels",
    "make_render_pixels_rl": "kinetix.render.pixels",
    # Looked up by name only: at run time the layers forbid an import from here.
    "make_inverse_render_symbolic": "kinetix.environment.inverse",
}


__all__ = ["make_inverse_render_symbolic", "make_render_pixels", "make_render_pixels_rl"]

__getattr__, __dir__ = lazy_names(__name__, _HOME)
