"""The gallery by mouse and keys in the real app: search, choose, put a set together, export it."""

import json

import numpy as np
import pytest

from kinetix.level.sets import load_set
from tests.editor.hosts.outputs import pixels

pytestmark = [pytest.mark.slow, pytest.mark.gl, pytest.mark.usefixtures("software_gl")]


def test_a_set_is_made_of_what_was_searched(run_editor, script, tmp_path):
    done = run_editor("--offscreen", "--size", "1280x800", "--replay", str(script("gallery.jsonl")))
    assert done.returncode == 0, done.stderr
    loaded = load_set(tmp_path / "set.json")
    assert [each.name for each in loaded.levels] == ["Clockwork", "Goalkeeper"]
    assert sorted(each.split for each in loaded.levels) == ["eval", "train"]
    state = json.loads((tmp_path / "state.json").read_text())
    assert state["mode"] == "edit" and not state["dirty"]
    gallery, found = pixels(tmp_path / "gallery.png"), pixels(tmp_path / "found.png")
    white = [(image == 255).all(axis=2).mean() for image in (gallery, found)]
    assert white[0] > 0.15 > white[1] > 0.005, "many pictures, then one"
    assert np.abs(pixels(tmp_path / "level.png") - gallery).mean() > 5
