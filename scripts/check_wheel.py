"""Check the wheel as a user gets it: empty environments, outside of any checkout.

    python3 scripts/check_wheel.py [--python 3.11 3.13] [--keep FOLDER] [--quick]

For every interpreter at hand the wheel is installed as README says, without and with the extra
`editor` (on the newest also with pygame-ce in pygame's place); README's and the guides' snippets
and commands run there, and the editor films its tour offscreen. For Python 3.14 the dependencies
are resolved from wheels alone, not run.
"""

import argparse
import glob
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
DEFAULT = ("3.11", "3.13")
RESOLVED_ONLY = "3.14"
RESOLVED_EXTRAS = ("", "editor", "gymnasium", "video")
SNIPPETS = ("README.md",)
"""Documents whose Python snippets run, in their order, in one process per document."""
TINY = (
    "--num-train-envs 8 --num-steps 16 --num-minibatches 2 --total-timesteps 256 --eval-freq 0 "
    "--physics fast"
)
SHORTER = {
    "kinetix train": TINY,
    "kinetix compare": "--attempts 2",
    "kinetix eval": "--attempts 2",
    "kinetix solve": "--seconds 5",
    "kinetix bench speed": "--batches 1",
}
"""Words added to commands that README prints with minutes of work."""
SKIPPED = ("kinetix bench chart",)
"""Commands that need the extra `bench`."""
LONGEST = 1800
"""A command that takes longer has failed [s]."""
MAY_FAIL = ("kinetix solve",)
"""Commands whose exit status says that nothing was found in the time."""


def main() -> int:
    """Check everything; 1 if something failed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--python", nargs="+", default=DEFAULT, metavar="VERSION")
    parser.add_argument("--keep", type=Path, help="work in this folder, and leave it")
    parser.add_argument("--quick", action="store_true", help="snippets and the shortest commands")
    arguments = parser.parse_args()
    folder = arguments.keep or Path(tempfile.mkdtemp(prefix="kinetix-wheel-"))
    folder.mkdir(parents=True, exist_ok=True)
    failures: list[str] = []
    try:
        wheel = build(folder)
        for version in arguments.python:
            python = interpreter(version)
            if python is None:
                say(f"{version}: no interpreter at hand, left out")
                continue
            lean = environment(folder / f"lean-{version}", python, str(wheel))
            failures += check_lean(lean, version)
            kinds = {"pygame": f"{wheel}[editor]"}
            if version == arguments.python[-1]:
                kinds["pygame-ce"] = f"{wheel}[editor]"
            for kind, requirement in kinds.items():
                full = environment(folder / f"{kind}-{version}", python, requirement)
                if kind == "pygame-ce":
                    pip(full, "uninstall", "-y", "pygame")
                    pip(full, "install", "pygame-ce>=2.5.6")
                name = f"{version} with {kind}"
                work = folder / f"work-{kind}-{version}"
                failures += check_editor(full, work, name)
                if kind == "pygame":
                    failures += check_readme(full, work, name, quick=arguments.quick)
        failures += check_resolves(wheel, folder)
    finally:
        if arguments.keep is None:
            shutil.rmtree(folder, ignore_errors=True)
    for failure in failures:
        say(f"FAILED {failure}")
    say("all good" if not failures else f"{len(failures)} failed")
    return 1 if failures else 0


def say(text: str) -> None:
    """Print at once."""
    print(text, flush=True)


def build(folder: Path) -> Path:
    """Return the wheel, built from the checkout."""
    command = [sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "-w", folder, ROOT]
    subprocess.run(command, check=True)
    (wheel,) = folder.glob("kinetix_editor-*.whl")
    with zipfile.ZipFile(wheel) as archive:
        say(f"{wheel.name}: {len(archive.namelist())} files, {wheel.stat().st_size / 2**20:.1f} MB")
    return wheel


def interpreter(version: str) -> str | None:
    """Return an interpreter of a version: on the path, of pyenv, or this one."""
    if sys.version.startswith(f"{version}."):
        return sys.executable
    pyenv = glob.glob(os.path.expanduser(f"~/.pyenv/versions/{version}.*/bin/python"))
    for candidate in (*pyenv, shutil.which(f"python{version}")):
        if candidate is None:
            continue
        # A shim of pyenv exists for versions that are not chosen.
        tried = subprocess.run([candidate, "-c", ""], capture_output=True, check=False)
        if not tried.returncode:
            return candidate
    return None


def environment(folder: Path, python: str, requirement: str) -> Path:
    """Return the `bin` of an environment that has nothing but the wheel and what it needs."""
    bin_folder = folder / "bin"
    if not folder.exists():
        subprocess.run([python, "-m", "venv", folder], check=True)
        pip(bin_folder, "install", requirement)
    return bin_folder


def pip(bin_folder: Path, *words: str) -> None:
    """Run pip of an environment."""
    command = [bin_folder / "python", "-m", "pip", "--disable-pip-version-check", *words]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"pip {' '.join(words)}: {done.stderr[-2000:]}")


def attempt(
    bin_folder: Path, work: Path, name: str, words: list[str], may_fail: bool = False
) -> list[str]:
    """Run a command of an environment in a folder; a sentence if it failed."""
    work.mkdir(parents=True, exist_ok=True)
    variables = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "VIRTUAL_ENV"))}
    variables |= {"PATH": f"{bin_folder}{os.pathsep}{os.environ['PATH']}"}
    began = time.monotonic()
    told = shlex.join(words)[:90]
    try:
        done = subprocess.run(
            words,
            cwd=work,
            env=variables,
            capture_output=True,
            text=True,
            check=False,
            timeout=LONGEST,
        )
    except subprocess.TimeoutExpired:
        say(f"FAILED {LONGEST:6.1f} s  {name}: {told}")
        return [f"{name}: {told}: not done after {LONGEST} s"]
    good = not done.returncode or (may_fail and done.returncode == 1)
    say(f"{'ok    ' if good else 'FAILED'} {time.monotonic() - began:6.1f} s  {name}: {told}")
    return [] if good else [f"{name}: {told}: {done.stderr.strip()[-1500:]}"]


def check_lean(bin_folder: Path, version: str) -> list[str]:
    """Check an installation without extras."""
    name, work = f"{version} without extras", bin_folder.parent / "work"
    code = (
        "import importlib.util as u, kinetix, pathlib, sys\n"
        f"assert not pathlib.Path(kinetix.__file__).is_relative_to({str(ROOT)!r})\n"
        "extras = ('pygame', 'imgui_bundle', 'gymnasium', 'wandb')\n"
        "assert not [name for name in extras if u.find_spec(name)]\n"
        "kinetix.load_agent('goalkeeper'); kinetix.load_level('s/goalkeeper')\n"
    )
    failures = attempt(bin_folder, work, name, ["python", "-c", code])
    for line in (
        f"kinetix train ppo --levels s/goalkeeper --out run {TINY}",
        "kinetix eval --agent run --levels s/goalkeeper --attempts 1",
        "kinetix --version",
    ):
        failures += attempt(bin_folder, work, name, shlex.split(line))
    without = subprocess.run(
        [bin_folder / "kinetix-editor"], capture_output=True, text=True, check=False, cwd=work
    )
    if without.returncode != 1 or "pip install 'kinetix-editor[editor]'" not in without.stderr:
        failures.append(f"{name}: kinetix-editor: {without.returncode} {without.stderr[-500:]}")
    return failures


def check_editor(bin_folder: Path, work: Path, name: str) -> list[str]:
    """Check that the editor draws and plays without a display."""
    work.mkdir(parents=True, exist_ok=True)
    (work / "events.jsonl").write_text(
        '{"do":"open","file":"s/goalkeeper"}\n{"do":"key","key":"space"}\n'
        '{"do":"wait_until","what":"playing","seconds":300}\n{"do":"hold","key":"left","frames":20}\n'
        '{"do":"screenshot","file":"shot.png"}\n{"do":"state","file":"state.json"}\n'
    )
    words = "kinetix-editor --offscreen --replay events.jsonl --size 1200x800"
    failures = attempt(bin_folder, work, name, shlex.split(words))
    if not failures and not (work / "shot.png").stat().st_size:
        failures.append(f"{name}: the editor's picture is empty")
    return failures


def check_readme(bin_folder: Path, work: Path, name: str, *, quick: bool) -> list[str]:
    """Run the snippets and the commands that documents print."""
    failures: list[str] = []
    for document in SNIPPETS:
        text = (ROOT / document).read_text(encoding="utf-8")
        code = "\n".join(re.findall(r"^```python\n(.*?)^```$", text, re.M | re.S))
        script = work / f"{Path(document).stem}.py"
        script.write_text(code, encoding="utf-8")
        failures += attempt(bin_folder, work, f"{name}, {document}", ["python", script.name])
    lines = re.findall(
        r"^(kinetix .*)$", "\n".join(re.findall(r"^```sh\n(.*?)^```$", text, re.M | re.S)), re.M
    )
    for line in lines:
        words = shlex.split(line, comments=True)
        command = " ".join(words)
        if command.startswith(SKIPPED) or (quick and not command.startswith("kinetix validate")):
            continue
        more = next((more for start, more in SHORTER.items() if command.startswith(start)), "")
        words = [found for word in words for found in _files(word)] + shlex.split(more)
        failures += attempt(bin_folder, work, name, words, may_fail=command.startswith(MAY_FAIL))
    return failures


def _files(word: str) -> list[str]:
    """Return the words that a shell in a checkout makes of one; bundled things go by name."""
    if "*" not in word:
        return [word]
    found = sorted(glob.glob(word, root_dir=ROOT))
    return [each.removeprefix("levels/").removesuffix(".json") for each in found]


def check_resolves(wheel: Path, folder: Path) -> list[str]:
    """Resolve everything for a Python that is not here, from wheels alone."""
    # pip reads markers such as python_version for the Python that runs it, so we read ours here.
    words = [sys.executable, "-m", "pip", "install", "-q", "--disable-pip-version-check"]
    words += ["--dry-run", "--python-version", RESOLVED_ONLY, "--only-binary=:all:"]
    words += ["--target", str(folder / "resolved"), *requirements(wheel, RESOLVED_ONLY)]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    good = not done.returncode
    say(f"{'ok    ' if good else 'FAILED'} {RESOLVED_ONLY}: resolved from wheels alone, not run")
    return [] if good else [f"{RESOLVED_ONLY}: {done.stderr.strip()[-1500:]}"]


def requirements(wheel: Path, version: str) -> list[str]:
    """Return what the wheel and its extras for users need on some version of Python."""
    from pip._vendor.packaging.requirements import Requirement

    with zipfile.ZipFile(wheel) as archive:
        (name,) = (name for name in archive.namelist() if name.endswith(".dist-info/METADATA"))
        lines = archive.read(name).decode().splitlines()
    needed: list[str] = []
    for line in lines:
        if not line.startswith("Requires-Dist: "):
            continue
        requirement = Requirement(line.removeprefix("Requires-Dist: "))
        python = {"python_version": version, "python_full_version": f"{version}.0"}
        wanted = requirement.marker is None or any(
            requirement.marker.evaluate(python | {"extra": extra}) for extra in RESOLVED_EXTRAS
        )
        if wanted:
            requirement.marker = None
            needed.append(str(requirement))
    return needed


if __name__ == "__main__":
    sys.exit(main())
