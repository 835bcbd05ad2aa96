"""What a training run leaves, as scripts: levels it keeps, runs beside each other, reasons."""

import itertools
import json
import shutil
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

from kinetix.level.codec import load_level
from kinetix.training.curricula.pages import page_updates, read_page

pytestmark = [pytest.mark.gl, pytest.mark.slow]

ACCEL = """train accel --preset small --seeds 2 --size s --total-timesteps 4096
    --observation-type symbolic_entity --kind entity_transformer --transformer-depth 1
    --transformer-size 16 --transformer-encoder-size 16 --num-heads 4
    --num-train-envs 8 --num-steps 32 --num-minibatches 2 --update-epochs 1
    --outer-rollout-steps 1 --level-buffer-capacity 16 --checkpoint-save-freq 4
    --eval-freq 4 --eval-levels s/hang_on s/goalkeeper --eval-num-attempts 2 --dummy-env --out"""
"""Two seeds of a curriculum, as small as they can be, of a network that attends to entities.

Levels are made, kept and edited; nothing moves in them, which is quick to compile.
"""


@pytest.fixture(scope="module")
def trained(tmp_path_factory):
    folder = tmp_path_factory.mktemp("trained") / "runs"
    command = [sys.executable, "-m", "kinetix", *ACCEL.split(), str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=590, check=False)
    assert done.returncode == 0, done.stderr
    return folder


@pytest.fixture
def replay(software_gl, trained, run_editor, script, tmp_path):
    """Runs a script, with the trained runs where it looks for them."""
    shutil.copytree(trained, tmp_path / "runs")

    def run(name):
        done = run_editor("--offscreen", "--replay", str(script(name)), timeout=590)
        assert done.returncode == 0, done.stderr

    return run


def record(tmp_path, name):
    return json.loads((tmp_path / f"{name}.json").read_text())


def differ(tmp_path, first, second):
    """The share of pixels in which two pictures differ."""
    with Image.open(tmp_path / f"{first}.png") as a, Image.open(tmp_path / f"{second}.png") as b:
        return np.mean(np.any(np.asarray(a.convert("RGB")) != np.asarray(b.convert("RGB")), -1))


def test_a_level_that_the_curriculum_keeps_is_opened_and_played(replay, tmp_path):
    replay("curriculum.jsonl")
    run = tmp_path / "runs" / "seed_0"
    newest = read_page(run, page_updates(run)[-1])
    playing = record(tmp_path, "playing")
    assert playing["mode"] == "playing" and playing["step"] > 0
    # The card that was clicked is the second of the newest page.
    opened = load_level(tmp_path / "level.json")
    assert opened.bodies == newest.levels[1].bodies
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
