"""A part of a frame that fails is reported, and what it left open in Dear ImGui is closed."""

import contextlib
from collections.abc import Iterator
from typing import TYPE_CHECKING

from imgui_bundle import imgui

if TYPE_CHECKING:
    from editor.session import Session


@contextlib.contextmanager
def guarded(session: "Session") -> Iterator[None]:
    """Draw a part of a frame; an exception of it ends neither the frame nor the app.

    Dear ImGui would close by itself what was left open, at the end of the window. There it fails
    over a table that scrolls; so all is closed here, where the part began.

    Args:
        session: The session that shows the exception.
    """
    opened = imgui.internal.ErrorRecoveryState()
    imgui.internal.error_recovery_store_state(opened)
    with session.guard():
        try:
            yield
        except Exception:
            imgui.internal.error_recovery_try_to_recover_state(opened)
            raise
