"""Every example runs as a user would run it."""

import runpy
import sys
from pathlib import Path

import pytest
from PIL import Image

from tests.isolated import python_with, run_with

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"

NEEDS = {"sb3_ppo": "stable_baselines3"}
"""Packages of examples that are too large to be fetched: without them the example is skipped."""
FETCHED = {"jaxued_replay": ("jaxued", "six"), "stoa_rollout": ("stoa-env",)}
"""Packages of examples that are no dependency: each gets an environment of its own."""

CHEAP = ["--physics", "jax2d"]
"""Compiles in half the time; the default physics has tests of its own."""
TRAINING = ["--num-train-envs", "8", "--num-steps", "16"]
TRAINING += ["--num-minibatches", "2", "--total-timesteps", "256"]

RUNS = {
    "stoa_rollout": ["--worlds", "4", "--steps", "300", *CHEAP],
    "jaxued_replay": ["--levels", "8", "--attempts", "2", "--steps", "4", *CHEAP],
    "ppo": ["--steps", "2048", "--envs", "8", "--levels", "s/goalkeeper", *CHEAP],
    "sb3_ppo": ["--steps", "4096", "--envs", "8"],
    "random_level_replay": ["--steps", "8", "--out", "new/film.gif", *CHEAP],
    "handmade_level_replay": CHEAP,
    "auto_reset": ["--worlds", "4", "--steps", "20", *CHEAP],
    "inverse_render": ["--out", "seen.png"],
    "domino": ["--dominoes", "30"],
    "batch_rollout": ["--worlds", "8", "--steps", "8", *CHEAP],
    "custom_level_to_training": ["--out", "trained", "--", *TRAINING, *CHEAP],
    "fine_tune": ["--out", "tuned", "--", *TRAINING, *CHEAP],
}


REFUSED = {
    "auto_reset": [(["--worlds", "-2"], "--worlds -2: expected at least 1")],
    "batch_rollout": [(["--steps", "0"], "--steps 0: expected at least 1")],
    "random_level_replay": [
        (["--out", "film.txt"], "--out film.txt: expected a name that ends in .gif or .mp4"),
        (["--steps", "0"], "--steps 0: expected at least 1"),
        (["--out", "taken/film.gif"], "error: taken: expected a folder, got a file"),
        (["--physics", "nope"], "error: unknown physics 'nope': expected one of jax2d"),
    ],
    "inverse_render": [(["--out", "seen.txt"], "--out seen.txt: expected a name that ends as")],
    "handmade_level_replay": [(["--level", "nope"], "error: nope: there is no such file")],
    "fine_tune": [(["--level", "nope"], "error: nope: there is no such file")],
    "ppo": [
        (["--plot", "seen.txt"], "--plot seen.txt: expected a name that ends in .png"),
        (["--envs", "0"], "--envs 0: expected at least 1"),
    ],
}
"""Words that an example cannot take, and what it says."""


@pytest.mark.parametrize("name", list(REFUSED))
def test_what_cannot_be_done_is_one_sentence(name, tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "taken").touch()
    for words, told in REFUSED[name]:
        monkeypatch.setattr("sys.argv", [f"{name}.py", *words])
        with pytest.raises(SystemExit) as ended:
            runpy.run_path(str(EXAMPLES / f"{name}.py"), run_name="__main__")
        # Python prints what is no number, and ends with status 1.
        said = ended.value.code if isinstance(ended.value.code, str) else capsys.readouterr().err
        assert told in said.splitlines()[-1]
    assert [path.name for path in tmp_path.iterdir()] == ["taken"]


def test_every_example_is_run_here() -> None:
    assert {file.stem for file in EXAMPLES.glob("*.py")} == set(RUNS)


@pytest.mark.slow
@pytest.mark.parametrize("name", list(RUNS))
def test_example(name: str, tmp_path: Path) -> None:
    if name in NEEDS:
        pytest.importorskip(NEEDS[name])
    python = Path(sys.executable)
    if name in FETCHED:
        python = python_with(tmp_path / "venv", *FETCHED[name])
    assert run_with(python, EXAMPLES / f"{name}.py", *RUNS[name], cwd=tmp_path).strip()
    for picture in (*tmp_path.rglob("*.gif"), *tmp_path.glob("*.png")):
        with Image.open(picture) as image:
            assert image.size == (125, 125)
            assert len(image.convert("RGB").getcolors() or []) > 3


@pytest.mark.slow(seconds=150)
@pytest.mark.usefixtures("fully_optimised")  # it runs for minutes
def test_stable_baselines3_learns_goalkeeper(tmp_path: Path) -> None:
    pytest.importorskip("stable_baselines3")
    script = EXAMPLES / "sb3_ppo.py"
    told = run_with(Path(sys.executable), script, cwd=tmp_path, seconds=2400)
    level, rate = told.strip().splitlines()[-1].removesuffix(" solved").split(": ")
    assert level == "s/goalkeeper"
    assert float(rate) >= 0.9
