"""Store of pictures that panels show; hosts keep them as textures."""

from typing import Protocol

import numpy as np
from imgui_bundle import imgui


class TextureStore(Protocol):
    """Keeps pictures where the panels can show them."""

    def texture(self, key: str, image: np.ndarray, stamp: int) -> imgui.ImTextureRef:
        """Return a texture that holds the picture; uploads only when the stamp is new.

        Args:
            key: Whose picture it is; one texture is kept per key.
            image: uint8[height, width, 3 or 4], top row first.
            stamp: Changes whenever the picture does.

        Returns:
            What `imgui.image` takes.
        """
        ...
