"""Drawing a finished Dear ImGui frame, and the textures that the app itself shows.

Dear ImGui's C++ OpenGL 3 renderer is used: it needs no Python binding of OpenGL and takes a
tenth of a millisecond a frame, half of what the one in Python takes.
"""

import dataclasses

import numpy as np
from imgui_bundle import imgui

from editor.hosts import gl


@dataclasses.dataclass(kw_only=True)
class _Slot:
    name: int
    shape: tuple[int, ...]
    stamp: int


class GlRenderer:
    """Dear ImGui on OpenGL 3.3 core; needs a current context."""

    def __init__(self) -> None:
        imgui.backends.opengl3_init("#version 330")
        self._slots: dict[str, _Slot] = {}

    def new_frame(self) -> None:
        """Prepare the device objects; before `imgui.new_frame`."""
        imgui.backends.opengl3_new_frame()

    def present(self, width: int, height: int, colour: tuple[float, float, float]) -> None:
        """Clear the window and draw what `imgui.render` left.

        Args:
            width: Width of the framebuffer [px].
            height: Height of the framebuffer [px].
            colour: Background, 0 … 1 each.
        """
        gl.clear(width, height, colour)
        imgui.backends.opengl3_render_draw_data(imgui.get_draw_data())

    def texture(self, key: str, image: np.ndarray, stamp: int) -> imgui.ImTextureRef:
        """See `TextureStore.texture`."""
        slot = self._slots.get(key)
        if slot is None:
            slot = _Slot(name=gl.create_texture(), shape=(), stamp=-1)
            self._slots[key] = slot
        if slot.stamp != stamp or slot.shape != image.shape:
            gl.upload_texture(slot.name, image, resized=slot.shape != image.shape)
            slot.shape, slot.stamp = image.shape, stamp
        return imgui.ImTextureRef(slot.name)

    @property
    def texture_count(self) -> int:
        """How many pictures are kept."""
        return len(self._slots)

    def shutdown(self) -> None:
        """Free everything; the context must still be current."""
        for slot in self._slots.values():
            gl.delete_texture(slot.name)
        self._slots.clear()
        imgui.backends.opengl3_shutdown()


class NullRenderer:
    """Pretends to draw: the app runs whole, without OpenGL and without a window."""

    def __init__(self) -> None:
        imgui.get_io().backend_flags |= imgui.BackendFlags_.renderer_has_textures.value

    def new_frame(self) -> None:
        """Nothing to prepare."""

    def present(self, width: int, height: int, colour: tuple[float, float, float]) -> None:
        """Tell Dear ImGui that its textures are where it wants them."""
        del width, height, colour
        for texture in imgui.get_platform_io().textures:
            if texture.status == imgui.ImTextureStatus.want_create:
                texture.set_tex_id(1)
                texture.status = imgui.ImTextureStatus.ok
            elif texture.status == imgui.ImTextureStatus.want_updates:
                texture.status = imgui.ImTextureStatus.ok
            elif texture.status == imgui.ImTextureStatus.want_destroy:
                texture.set_tex_id(0)
                texture.status = imgui.ImTextureStatus.destroyed

    def texture(self, key: str, image: np.ndarray, stamp: int) -> imgui.ImTextureRef:
        """See `TextureStore.texture`."""
        del key, image, stamp
        return imgui.ImTextureRef(1)

    def shutdown(self) -> None:
        """Let go of Dear ImGui's textures, as its context demands."""
        for texture in imgui.get_platform_io().textures:
            texture.set_tex_id(0)
            texture.status = imgui.ImTextureStatus.destroyed
        flags = imgui.get_io().backend_flags
        imgui.get_io().backend_flags = flags & ~imgui.BackendFlags_.renderer_has_textures.value
