"""Thumbnails on the screen share a fixed number of textures, however many levels go by."""

import types

import numpy as np

from editor.gallery.thumbnail import SIDE
from editor.toolkit.thumbnails import SLOTS, UPLOADS, Thumbs


class Store:
    def __init__(self):
        self.uploads = {}

    def texture(self, key, image, stamp):
        if self.uploads.get(key) != stamp:
            self.uploads[key] = stamp
        return (key, stamp)


def test_more_levels_than_textures_take_turns():
    store = Store()
    thumbs = Thumbs(store)
    picture = np.zeros((SIDE, SIDE, 3), np.uint8)
    library = types.SimpleNamespace(picture=lambda sha256: picture)
    session = types.SimpleNamespace(library=library)
    shown = {}
    for k in range(3 * SLOTS):
        if k % UPLOADS == 0:
            thumbs.begin_frame()
        shown[k] = thumbs.texture(session, f"{k:064}")
    assert len(store.uploads) == SLOTS
    # The newest keep theirs, and no two of them share one.
    newest = [thumbs.texture(session, f"{k:064}") for k in range(2 * SLOTS, 3 * SLOTS)]
    assert newest == [shown[k] for k in range(2 * SLOTS, 3 * SLOTS)]
    assert len(set(newest)) == SLOTS


def test_a_frame_uploads_only_a_few():
    thumbs = Thumbs(Store())
    session = types.SimpleNamespace(
        library=types.SimpleNamespace(picture=lambda sha256: np.zeros((SIDE, SIDE, 3), np.uint8))
    )
    thumbs.begin_frame()
    made = [thumbs.texture(session, f"{k:064}") for k in range(3 * UPLOADS)]
    assert [texture is not None for texture in made] == [True] * UPLOADS + [False] * 2 * UPLOADS
