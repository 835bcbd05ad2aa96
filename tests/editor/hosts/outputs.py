"""Files that replay scripts write."""

import json

import numpy as np
from PIL import Image


def pixels(path) -> np.ndarray:
    """Colours of a picture, as whole numbers."""
    with Image.open(path) as image:
        return np.asarray(image.convert("RGB")).astype(int)


def record(tmp_path, name):
    """Return the JSON that the event `state` wrote."""
    return json.loads((tmp_path / f"{name}.json").read_text())
