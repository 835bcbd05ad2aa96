"""Thumbnails on the screen: a fixed number of textures that the cards in sight share."""

import collections
import dataclasses
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor.gallery.library import Thumbnail
from editor.toolkit.textures import TextureStore

if TYPE_CHECKING:
    from editor.session import Session

SLOTS: Final = 160
"""Textures for thumbnails; the ones that were not seen for longest are given to others."""
UPLOADS: Final = 4
"""Most thumbnails that become textures in one frame: scrolling stays smooth."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class _Slot:
    number: int
    picture: Thumbnail
    stamp: int


class Thumbs:
    """Hands out a texture for a level's hash as soon as there is a picture."""

    def __init__(self, store: TextureStore) -> None:
        self._store = store
        self._slots: collections.OrderedDict[str, _Slot] = collections.OrderedDict()
        self._stamp = 0
        self._uploads = 0

    def begin_frame(self) -> None:
        """Allow this frame's uploads."""
        self._uploads = UPLOADS

    def texture(self, session: "Session", sha256: str) -> imgui.ImTextureRef | None:
        """Return the texture of a level's thumbnail; None while it is being made."""
        slot = self._slots.get(sha256)
        if slot is None:
            picture = session.library.picture(sha256) if self._uploads > 0 else None
            if picture is None:
                return None
            self._uploads -= 1
            self._stamp += 1
            number = len(self._slots)
            if number >= SLOTS:
                number = self._slots.popitem(last=False)[1].number
            slot = _Slot(number=number, picture=picture, stamp=self._stamp)
            self._slots[sha256] = slot
        else:
            self._slots.move_to_end(sha256)
        return self._store.texture(f"thumbnail-{slot.number}", slot.picture, slot.stamp)
