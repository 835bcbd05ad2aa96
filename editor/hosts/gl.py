"""The few functions of OpenGL that the app calls itself, through ctypes.

Dear ImGui's own renderer does the drawing. What is left (clearing, textures, a picture that lasts
from frame to frame, reading a screenshot back) is so little that a whole binding of OpenGL would be
dead weight; and PyOpenGL has to be told which platform SDL chose, which breaks on Wayland and
offscreen (pygame/pygame#3110). The system's OpenGL library dispatches to whatever context is
current.
"""

import ctypes
import ctypes.util
import functools
import sys

import numpy as np

from kinetix.errors import KinetixError

_COLOR_BUFFER_BIT = 0x4000
_TEXTURE_2D = 0x0DE1
_RGB, _RGBA, _UNSIGNED_BYTE = 0x1907, 0x1908, 0x1401
_RGB8 = 0x8051
_UNPACK_ALIGNMENT, _PACK_ALIGNMENT = 0x0CF5, 0x0D05
_MIN_FILTER, _MAG_FILTER, _LINEAR = 0x2801, 0x2800, 0x2601
_FRAMEBUFFER, _READ_FRAMEBUFFER, _DRAW_FRAMEBUFFER = 0x8D40, 0x8CA8, 0x8CA9
_COLOR_ATTACHMENT, _FRAMEBUFFER_COMPLETE, _SCISSOR_TEST = 0x8CE0, 0x8CD5, 0x0C11
_NEAREST = 0x2600
_WRAP_S, _WRAP_T, _CLAMP_TO_EDGE = 0x2802, 0x2803, 0x812F

_CANDIDATES = {
    "linux": ("libGL.so.1", "libOpenGL.so.0"),
    "darwin": ("/System/Library/Frameworks/OpenGL.framework/OpenGL",),
    "win32": ("opengl32",),
}


@functools.cache
def _library() -> ctypes.CDLL:
    names = _CANDIDATES.get(sys.platform, ("libGL.so.1",))
    for name in names:
        try:
            return ctypes.CDLL(name)
        except OSError:
            continue
    raise KinetixError(
        f"no OpenGL library found (tried {', '.join(names)}); install the system's OpenGL packages"
    )


def _f(value: float) -> ctypes.c_float:
    return ctypes.c_float(value)


def clear(width: int, height: int, colour: tuple[float, float, float]) -> None:
    """Set the viewport and fill the window.

    Args:
        width: Width of the framebuffer [px].
        height: Height of the framebuffer [px].
        colour: Red, green, blue, each 0 … 1.
    """
    gl = _library()
    gl.glViewport(0, 0, width, height)
    gl.glClearColor(_f(colour[0]), _f(colour[1]), _f(colour[2]), _f(1.0))
    gl.glClear(_COLOR_BUFFER_BIT)


def clear_part(
    box: tuple[int, int, int, int], height: int, colour: tuple[float, float, float]
) -> None:
    """Fill a part of the window.

    Args:
        box: Left, top, right, bottom [px], from the upper left corner.
        height: Height of the framebuffer [px].
        colour: Red, green, blue, each 0 … 1.
    """
    gl = _library()
    left, top, right, bottom = box
    gl.glEnable(_SCISSOR_TEST)
    gl.glScissor(left, height - bottom, right - left, bottom - top)
    gl.glClearColor(_f(colour[0]), _f(colour[1]), _f(colour[2]), _f(1.0))
    gl.glClear(_COLOR_BUFFER_BIT)
    gl.glDisable(_SCISSOR_TEST)


class Canvas:
    """A picture in the graphics memory that keeps what was drawn until it is drawn over."""

    def __init__(self, width: int, height: int) -> None:
        """Make one; its content is undefined at first.

        Raises:
            KinetixError: The driver has no framebuffer objects.
        """
        gl = _library()
        if not all(hasattr(gl, name) for name in _CANVAS_FUNCTIONS):
            raise KinetixError("this OpenGL has no framebuffer objects")
        self.size = (width, height)
        self._texture = create_texture()
        gl.glTexImage2D(_TEXTURE_2D, 0, _RGB8, width, height, 0, _RGB, _UNSIGNED_BYTE, None)
        name = ctypes.c_uint(0)
        gl.glGenFramebuffers(1, ctypes.byref(name))
        self._name = int(name.value)
        self.bind()
        gl.glFramebufferTexture2D(
            _FRAMEBUFFER, _COLOR_ATTACHMENT, _TEXTURE_2D, ctypes.c_uint(self._texture), 0
        )
        complete = gl.glCheckFramebufferStatus(_FRAMEBUFFER) == _FRAMEBUFFER_COMPLETE
        self.unbind()
        if not complete:
            self.delete()
            raise KinetixError("this OpenGL has no framebuffer objects")

    def bind(self) -> None:
        """Draw into it from now on."""
        _library().glBindFramebuffer(_FRAMEBUFFER, ctypes.c_uint(self._name))

    def unbind(self) -> None:
        """Draw into the window again."""
        _library().glBindFramebuffer(_FRAMEBUFFER, ctypes.c_uint(0))

    def show(self) -> None:
        """Copy it into the window."""
        gl = _library()
        width, height = self.size
        gl.glBindFramebuffer(_READ_FRAMEBUFFER, ctypes.c_uint(self._name))
        gl.glBindFramebuffer(_DRAW_FRAMEBUFFER, ctypes.c_uint(0))
        whole = (0, 0, width, height)
        gl.glBlitFramebuffer(*whole, *whole, _COLOR_BUFFER_BIT, _NEAREST)
        self.unbind()

    def pixels(self) -> np.ndarray:
        """Return the picture: uint8[height, width, 3], top row first."""
        self.bind()
        pixels = read_pixels(*self.size)
        self.unbind()
        return pixels

    def delete(self) -> None:
        """Free the framebuffer."""
        gl = _library()
        gl.glDeleteFramebuffers(1, ctypes.byref(ctypes.c_uint(self._name)))
        delete_texture(self._texture)


_CANVAS_FUNCTIONS = (
    "glGenFramebuffers",
    "glBindFramebuffer",
    "glFramebufferTexture2D",
    "glCheckFramebufferStatus",
    "glBlitFramebuffer",
    "glDeleteFramebuffers",
)


def finish() -> None:
    """Wait until the driver has drawn everything (screenshots and timings need it)."""
    _library().glFinish()


def read_pixels(width: int, height: int) -> np.ndarray:
    """Return the framebuffer as it is now.

    Args:
        width: Width of the framebuffer [px].
        height: Height of the framebuffer [px].

    Returns:
        uint8[height, width, 3], top row first.
    """
    gl = _library()
    pixels = np.empty((height, width, 3), np.uint8)
    gl.glPixelStorei(_PACK_ALIGNMENT, 1)
    gl.glReadPixels(
        0, 0, width, height, _RGB, _UNSIGNED_BYTE, pixels.ctypes.data_as(ctypes.c_void_p)
    )
    return pixels[::-1].copy()


def create_texture() -> int:
    """Return a new, empty texture with linear filtering.

    Returns:
        Its OpenGL name.
    """
    gl = _library()
    name = ctypes.c_uint(0)
    gl.glGenTextures(1, ctypes.byref(name))
    gl.glBindTexture(_TEXTURE_2D, name)
    for parameter, value in (
        (_MIN_FILTER, _LINEAR),
        (_MAG_FILTER, _LINEAR),
        (_WRAP_S, _CLAMP_TO_EDGE),
        (_WRAP_T, _CLAMP_TO_EDGE),
    ):
        gl.glTexParameteri(_TEXTURE_2D, parameter, value)
    return int(name.value)


def upload_texture(name: int, image: np.ndarray, *, resized: bool) -> None:
    """Put a picture into a texture.

    Args:
        name: The texture.
        image: uint8[height, width, 3 or 4], top row first.
        resized: Whether the texture's storage must be allocated for this size.
    """
    gl = _library()
    height, width, channels = image.shape
    layout = _RGB if channels == 3 else _RGBA
    pixels = np.ascontiguousarray(image)
    data = pixels.ctypes.data_as(ctypes.c_void_p)
    gl.glBindTexture(_TEXTURE_2D, ctypes.c_uint(name))
    gl.glPixelStorei(_UNPACK_ALIGNMENT, 1)
    if resized:
        storage = _RGB8 if channels == 3 else _RGBA
        gl.glTexImage2D(_TEXTURE_2D, 0, storage, width, height, 0, layout, _UNSIGNED_BYTE, data)
    else:
        gl.glTexSubImage2D(_TEXTURE_2D, 0, 0, 0, width, height, layout, _UNSIGNED_BYTE, data)


def delete_texture(name: int) -> None:
    """Free a texture."""
    _library().glDeleteTextures(1, ctypes.byref(ctypes.c_uint(name)))
