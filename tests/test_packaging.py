"""The wheel works outside the repository, with its levels."""

import os
import subprocess
import sys
import sysconfig
import tomllib
import venv
import zipfile
from functools import partial
from pathlib import Path

import pytest

from kinetix.paths import levels_dir
from tests.pace import share_of

ROOT = Path(__file__).resolve().parents[1]


def run(*words, **options):
    """Run a program and return what it printed."""
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    done = subprocess.run(
        [str(word) for word in words],
        capture_output=True,
        text=True,
        check=False,
        env=environment,
        **options,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheel")
    run(sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "-w", folder, ROOT)
    (built,) = folder.glob("kinetix_editor-*.whl")
    return built


@pytest.fixture(scope="module")
def installed(wheel, tmp_path_factory):
    """Folder with the scripts of an environment that has the wheel, and our packages to lean on."""
    folder = tmp_path_factory.mktemp("environment")
    venv.create(folder, with_pip=False)
    (site,) = folder.glob("lib/python*/site-packages")
    run(
        *(sys.executable, "-m", "pip", "install", "-q", "--no-deps", "--no-warn-script-location"),
        *("--prefix", folder, "--ignore-installed", wheel),
    )
    assert (site / "kinetix").is_dir()
    # Added without its .pth files: one of them points back at the checkout.
    (site / "lean.pth").write_text(sysconfig.get_path("purelib") + "\n")
    return folder / "bin"


@pytest.mark.slow
def test_wheel_has_code_levels_and_assets_and_nothing_else(wheel):
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
    assert {name.split("/")[0].split("-")[0] for name in names} == {
        "kinetix",
        "editor",
        "kinetix_editor",
    }
    ours = {str(path.relative_to(levels_dir())) for path in levels_dir().rglob("*.json")}
    packed = {
        name.removeprefix("kinetix/_data/levels/") for name in names if "_data/levels" in name
    }
    assert packed == ours
    assert "editor/assets/tour.jsonl" in names
    assert "kinetix/py.typed" in names


@pytest.mark.slow
def test_an_installed_copy_works_outside_the_repository(installed, tmp_path):
    shown = run(
        *(installed / "python", "-c"),
        "import kinetix, sys; level = kinetix.load_level('s/first_flight'); "
        "print(kinetix.__file__); print(level.name)",
        cwd=tmp_path,
    )
    place, name = shown.splitlines()
    assert not Path(place).is_relative_to(ROOT)
    assert name == "First flight"
    assert run(installed / "kinetix", "validate", "s/first_flight", cwd=tmp_path)


def test_what_the_commands_promise_is_what_the_project_declares():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert project["scripts"] == {
        "kinetix": "kinetix.cli:main",
        "kinetix-editor": "editor.__main__:main",
    }
    assert project["requires-python"].startswith(">=3.11")
    assert "jax>=0.9,!=0.10.2" in project["dependencies"]
    # What is asked for only by name must not be needed without it.
    assert not {"wandb", "tensorflow", "hydra-core"} & {
        requirement.split(">")[0] for requirement in project["dependencies"]
    }


def test_system_packages_are_named_in_one_place():
    listed = {
        line
        for line in (ROOT / "scripts" / "system-packages.txt").read_text().splitlines()
        if line and not line.startswith("#")
    }
    assert {"libegl1", "libgl1", "libgl1-mesa-dri", "xvfb"} <= listed
    others = [ROOT / "Makefile", ROOT / ".ci" / "run", ROOT / "README.md", ROOT / "CONTRIBUTING.md"]
    for path in [*others, *(ROOT / "scripts").glob("*.sh"), *(ROOT / "scripts").glob("*.py")]:
        # A test mark and a program are called as the packages that they need.
        text = path.read_text().replace("| `xvfb` |", "").replace('which("chromium")', "")
        assert [package for package in listed if package in text] == [], path


WITHOUT_TOOLKIT = "import sys; sys.modules['pygame'] = sys.modules['imgui_bundle'] = None; "


def test_the_editor_without_its_toolkit_says_so_in_one_line():
    done = subprocess.run(
        [
            sys.executable,
            "-c",
            f"{WITHOUT_TOOLKIT}sys.argv = ['kinetix-editor']; "
            "import editor.__main__ as app; sys.exit(app.main())",
        ],
        capture_output=True,
        text=True,
        check=False,
        cwd=ROOT,
    )
    assert done.returncode == 1
    assert done.stderr == (
        "kinetix-editor: pygame and imgui_bundle not installed: "
        "pip install 'kinetix-editor[editor]'\n"
    )


def test_training_and_evaluation_do_without_the_toolkit():
    names = ", ".join(
        f"kinetix.cli.{name}" for name in ("train", "eval", "render", "play", "bench")
    )
    run(
        *(sys.executable, "-c"),
        f"{WITHOUT_TOOLKIT}import {names}, kinetix.training.run, kinetix.agents.evaluate",
        cwd=ROOT,
    )


def test_importing_kinetix_is_quick():
    code = "import time; t = time.process_time(); import kinetix; print(time.process_time() - t)"
    took = partial(run, sys.executable, "-c", code, cwd=ROOT)
    assert share_of(0.1, took, seconds=lambda ask: float(str(ask())), tries=15) <= 1


def test_both_commands_tell_the_version():
    import kinetix

    for words in (("kinetix.cli", "main(['--version'])"), ("editor.__main__", "main()")):
        code = f"import sys; sys.argv = ['x', '--version']; import {words[0]} as m; m.{words[1]}"
        assert run(sys.executable, "-c", code, cwd=ROOT).strip() == kinetix.__version__
