"""The line of words on films."""

import numpy as np
from PIL import Image

from kinetix.render.captions import caption, write_caption


def test_a_caption_names_keys_value_and_outcome():
    words = caption(7, (1.0, -1.0, 0.0, 0.01, 1.0, 0.0), "won", value=0.5, entropy=1.25)
    assert words == "step 7  value +0.50  entropy 1.25  left  down  1  won"
    assert caption(0, ()) == "step 0"


def test_a_caption_changes_the_upper_left_corner_only():
    picture = Image.new("RGB", (200, 200), (255, 255, 255))
    write_caption(picture, caption(3, ()))
    changed = (np.asarray(picture) != 255).any(axis=-1)
    assert changed[:16, :80].any()
    assert not changed[40:].any()
