"""Drawing a finished Dear ImGui frame, and the textures that the app itself shows.

Dear ImGui's C++ OpenGL 3 renderer is used: it needs no Python binding of OpenGL and takes a
tenth of a millisecond a frame, half of what the one in Python takes.
"""

import dataclasses
import enum

import numpy as np
from imgui_bundle import imgui

from editor.hosts import gl
from editor.hosts.damage import DrawnList, Rect, area, damage, drawn_lists, intersection
from kinetix.errors import KinetixError


class Window(enum.Enum):
    """Changes of a window's content from one frame to the next."""

    FADES = enum.auto()
    """It is undefined after every frame: the picture is kept elsewhere and copied."""
    LASTS = enum.auto()
    """It stays, as in an EGL pbuffer: the frame is drawn right into it."""
    UNSEEN = enum.auto()
    """Nobody looks at the window: the picture is kept elsewhere and read from there."""


@dataclasses.dataclass(kw_only=True)
class _Slot:
    name: int
    shape: tuple[int, ...]
    stamp: int


class GlRenderer:
    """Dear ImGui on OpenGL 3.3 core; needs a current context.

    Only what a frame changes is drawn, into a picture that lasts; that is copied into the window,
    whose own content is undefined after every frame.
    """

    def __init__(self, window: Window = Window.FADES) -> None:
        """Start the renderer of a window.

        Args:
            window: What becomes of the window's content.
        """
        imgui.backends.opengl3_init("#version 330")
        self._slots: dict[str, _Slot] = {}
        self._canvas: gl.Canvas | None = None
        self._keeps = True
        self._window = window
        self._size = (0, 0)
        self._before: list[DrawnList] | None = None
        self._touched: set[int] = set()

    def new_frame(self) -> None:
        """Prepare the device objects; before `imgui.new_frame`."""
        imgui.backends.opengl3_new_frame()

    def present(self, width: int, height: int, colour: tuple[float, float, float]) -> bool:
        """Draw what `imgui.render` left, as far as it differs from what the window shows.

        Args:
            width: Width of the framebuffer [px].
            height: Height of the framebuffer [px].
            colour: Background, 0 … 1 each.

        Returns:
            Whether anything differs.
        """
        data = imgui.get_draw_data()
        lasts = self._window is Window.LASTS
        canvas = None if lasts else self._canvas_of(width, height)
        if canvas is None and not lasts:
            gl.clear(width, height, colour)
            imgui.backends.opengl3_render_draw_data(data)
            return True
        rects = self._differences(data, (width, height))
        if rects == []:
            return False
        if canvas is not None:
            canvas.bind()
        if rects is None:
            gl.clear(width, height, colour)
            imgui.backends.opengl3_render_draw_data(data)
        else:
            for rect in rects:
                left, top, right, bottom = map(int, rect)
                gl.clear_part((left, top, right, bottom), height, colour)
                _draw_part(data, rect)
        if canvas is not None:
            canvas.unbind()
            if self._window is not Window.UNSEEN:
                canvas.show()
        return True

    def _differences(self, data: imgui.ImDrawData, size: tuple[int, int]) -> list[Rect] | None:
        """Return the differences from the frame before; None: everything."""
        # Textures that are not there yet have no number that could be compared.
        complete = all(
            texture.status != imgui.ImTextureStatus.want_create
            for texture in imgui.get_platform_io().textures
        )
        lists = drawn_lists(data) if complete else None
        rects = None
        if self._before is not None and lists is not None and self._size == size:
            rects = damage(self._before, lists, size, self._touched)
        self._before, self._size = lists, size
        self._touched.clear()
        return rects

    def invalidate(self) -> None:
        """Draw everything in the next frame: the window has lost what it showed."""
        self._before = None

    def leave_window(self) -> None:
        """Keep the picture elsewhere from now on: it gets another size than the window."""
        self._window = Window.UNSEEN

    def _canvas_of(self, width: int, height: int) -> gl.Canvas | None:
        """Return the picture that lasts, as large as the window; None where there can be none."""
        if not self._keeps or (self._canvas is not None and self._canvas.size == (width, height)):
            return self._canvas
        if self._canvas is not None:
            self._canvas.delete()
        self._before = self._canvas = None
        try:
            self._canvas = gl.Canvas(width, height)
        except KinetixError:
            self._keeps = False
        return self._canvas

    def pixels(self, width: int, height: int, colour: tuple[float, float, float]) -> np.ndarray:
        """The last frame: uint8[height, width, 3], top row first; arguments as of `present`."""
        self.present(width, height, colour)
        return self.read(width, height)

    def read(self, width: int, height: int) -> np.ndarray:
        """Return what was presented last: uint8[height, width, 3], top row first."""
        if self._canvas is not None:
            return self._canvas.pixels()
        return gl.read_pixels(width, height)

    def texture(self, key: str, image: np.ndarray, stamp: int) -> imgui.ImTextureRef:
        """Return the texture of an image, as `TextureStore.texture` does."""
        slot = self._slots.get(key)
        if slot is None:
            slot = _Slot(name=gl.create_texture(), shape=(), stamp=-1)
            self._slots[key] = slot
        if slot.stamp != stamp or slot.shape != image.shape:
            gl.upload_texture(slot.name, image, resized=slot.shape != image.shape)
            self._touched.add(slot.name)
            slot.shape, slot.stamp = image.shape, stamp
        return imgui.ImTextureRef(slot.name)

    @property
    def texture_count(self) -> int:
        """Number of pictures kept."""
        return len(self._slots)

    def shutdown(self) -> None:
        """Free everything; the context must still be current."""
        for slot in self._slots.values():
            gl.delete_texture(slot.name)
        self._slots.clear()
        if self._canvas is not None:
            self._canvas.delete()
        imgui.backends.opengl3_shutdown()


def _pixels_of(clip: Rect, height: float) -> Rect:
    """Return the whole pixels that Dear ImGui's renderer leaves of a clip rectangle [px].

    It cuts off fractions from the left and lower edges, and from width and height, not from the
    other edges.
    """
    left, top, right, bottom = clip
    low, under = int(left), int(height - bottom)
    upper = height - under
    return float(low), upper - int(bottom - top), float(low + int(right - left)), upper


def _draw_part(data: imgui.ImDrawData, rect: Rect) -> None:
    """Draw only what lies within a rectangle [px]."""
    # Only by index are they the commands themselves: going through the buffer gives copies.
    commands = [one.cmd_buffer[k] for one in data.cmd_lists for k in range(one.cmd_buffer.size())]
    clips = [command.clip_rect for command in commands]
    kept = [(clip.x, clip.y, clip.z, clip.w) for clip in clips]
    for command, clip in zip(commands, kept, strict=True):
        shared = intersection(_pixels_of(clip, data.display_size.y), rect)
        # The renderer passes over commands whose rectangle is empty.
        visible = shared if area(shared) > 0 else (0.0, 0.0, 0.0, 0.0)
        command.clip_rect = imgui.ImVec4(*visible)
    imgui.backends.opengl3_render_draw_data(data)
    for command, clip in zip(commands, kept, strict=True):
        command.clip_rect = imgui.ImVec4(*clip)


class NullRenderer:
    """Pretends to draw: the app runs whole, without OpenGL and without a window."""

    def __init__(self) -> None:
        imgui.get_io().backend_flags |= imgui.BackendFlags_.renderer_has_textures.value

    def new_frame(self) -> None:
        """Do nothing: this renderer needs no preparation."""

    def present(self, width: int, height: int, colour: tuple[float, float, float]) -> bool:
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
        return True

    def texture(self, key: str, image: np.ndarray, stamp: int) -> imgui.ImTextureRef:
        """Return the texture of an image, as `TextureStore.texture` does."""
        del key, image, stamp
        return imgui.ImTextureRef(1)

    def shutdown(self) -> None:
        """Let go of Dear ImGui's textures, as its context demands."""
        for texture in imgui.get_platform_io().textures:
            texture.set_tex_id(0)
            texture.status = imgui.ImTextureStatus.destroyed
        flags = imgui.get_io().backend_flags
        imgui.get_io().backend_flags = flags & ~imgui.BackendFlags_.renderer_has_textures.value
