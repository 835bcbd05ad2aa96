"""Replay scripts of the views on a training run: its curriculum, other seeds, reasons of agents."""

import itertools

import numpy as np
import pytest
from PIL import Image

from kinetix.level.codec import load_level
from tests.editor.hosts.outputs import record
from tests.editor.hosts.runs import LEVELS, write_run

pytestmark = [pytest.mark.gl, pytest.mark.slow]


@pytest.fixture
def replay(software_gl, run_editor, script, tmp_path):
    """Runs a script, with two runs where it looks for them."""
    for seed in range(2):
        write_run(tmp_path / "runs" / f"seed_{seed}", seed)

    def run(name):
        done = run_editor("--offscreen", "--replay", str(script(name)), timeout=590)
        assert done.returncode == 0, done.stderr

    return run


def differ(tmp_path, first, second):
    """The share of pixels in which two pictures differ."""
    with Image.open(tmp_path / f"{first}.png") as a, Image.open(tmp_path / f"{second}.png") as b:
        return np.mean(np.any(np.asarray(a.convert("RGB")) != np.asarray(b.convert("RGB")), -1))


def test_a_level_that_the_curriculum_keeps_is_opened_and_played(replay, tmp_path):
    replay("curriculum.jsonl")
    playing = record(tmp_path, "playing")
    assert playing["mode"] == "playing" and playing["step"] > 0
    # The card that was clicked is the second, of an earlier page and of the newest.
    for name, expected in (("earlier_level", LEVELS[1]), ("level", LEVELS[-2])):
        assert load_level(tmp_path / f"{name}.json").bodies == load_level(expected).bodies
    assert record(tmp_path, "after")["mode"] == "edit"
    assert differ(tmp_path, "newest", "earlier") > 0.01


def test_runs_stand_beside_each_other_with_what_changes_their_look(replay, tmp_path):
    replay("runs_beside.jsonl")
    looks = ["alone", "beside", "smoothed", "band", "log", "dropped"]
    for before, after in itertools.pairwise(looks):
        assert differ(tmp_path, before, after) > 0.001, (before, after)
    # The slider over the run's checkpoints shows another one.
    assert differ(tmp_path, "newest", "earlier") > 0.0005
    assert record(tmp_path, "after")["mode"] == "edit"


def test_an_agent_is_asked_why(replay, tmp_path):
    replay("ask_why.jsonl")
    for shown in ("attention", "saliency_value", "saliency_action", "places"):
        assert differ(tmp_path, "plain", shown) > 0.002, shown
    assert differ(tmp_path, "saliency_value", "saliency_action") > 0.0002
    # The values of places tint the whole arena.
    assert differ(tmp_path, "plain", "places") > 0.1
    assert record(tmp_path, "after")["mode"] == "edit"
