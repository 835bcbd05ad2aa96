"""The nine functions of OpenGL 1.1 that the app calls itself, through ctypes.

Dear ImGui's own renderer does the drawing. What is left (clearing, the play picture's texture,
reading a screenshot back) is so little that a whole binding of OpenGL would be dead weight; and
PyOpenGL has to be told which platform SDL chose, which breaks on Wayland and offscreen
(pygame/pygame#3110). The system's OpenGL library dispatches to whatever context is current.
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


def finish() -> None:
    """Wait until the driver has drawn everything (screenshots and timings need it)."""
    _library().glFinish()


def read_pixels(width: int, height: int) -> np.ndarray:
    """The framebuffer as it is now.

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
    """A new, empty texture with linear filtering.

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
        resized: Whether the texture's storage must be made anew for this size.
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
