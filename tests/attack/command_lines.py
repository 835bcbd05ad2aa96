"""Command lines, drawn at random: nasty words, damaged files, flags of other commands."""

import contextlib
import io
import os
import random
from pathlib import Path

from kinetix import cli
from tests.attack import levels
from tests.attack.mutate import Mutator

_WORDS = (
    "",
    "-",
    "--",
    "-h",
    "--json",
    "--no-such",
    "--seed",
    "--count",
    "--size",
    "s",
    "xl",
    "0",
    "-1",
    "1e9",
    "nan",
    "s/first_flight",
    "s/no_such_level",
    "/dev/zero",
    "/dev/null",
    "/proc/self/mem",
    "n" * 300,
    "\x1b[2J",
    "\udcff",
    "ä灯",
    "../..",
    "~",
    "a\0b",
    "--split",
    "0.5",
    "2",
    "--inline",
    "--levels",
    "--out",
    "--format",
    "kinetix-env",
    "kinetix-level",
)
_LIGHT = ("validate", "convert", "levelset build", "levelset split", "levelset")
"""Commands that are quick enough to be run by thousands."""
_PARSED = ("render", "play", "eval", "solve", "sample", "bench", "train")
"""Commands that are only given what they must refuse."""


def _files(random_: random.Random, folder: Path) -> list[str]:
    mutator = Mutator(random_.getrandbits(64))
    samples = (levels.native_levels, levels.kinetix_env_levels, levels.level_sets)
    names = []
    for k, make in enumerate(samples):
        sample = random_.choice(make())
        path = folder / f"{k}.json"
        path.write_bytes(mutator.damaged(sample) if random_.random() < 0.7 else sample)
        names.append(str(path))
    if not (folder / "pipe.json").exists():
        os.mkfifo(folder / "pipe.json")
        (folder / "loop.json").symlink_to("loop.json")
        (folder / "round").symlink_to(".")
    return [*names, str(folder), str(folder / "pipe.json"), str(folder / "loop.json")]


def words_of(random_: random.Random, folder: Path) -> list[str]:
    """A command line."""
    if random_.random() < 0.05:
        return [random_.choice((*_WORDS, "vaildate", "--version", "--help"))]
    if random_.random() < 0.1:
        # A word that no option takes: the parser must refuse it before anything heavy starts.
        return [*random_.choice(_PARSED).split(), "--no-such-option", random_.choice(_WORDS)]
    files = _files(random_, folder)
    out = str(
        folder / random_.choice(("out.json", "round/out.json", "0.json", "n" * 250 + ".json"))
    )
    pool = [*files, *files, out, *_WORDS]
    return [
        *random_.choice(_LIGHT).split(),
        *(random_.choice(pool) for _ in range(random_.randrange(5))),
    ]


def run_words(random_: random.Random, folder: Path) -> None:
    """Run a command line; it ends with 0, 1 or 2, and never with a crash report."""
    words = words_of(random_, folder)
    before = Path.cwd()
    crashes = folder / "state" / "kinetix-editor" / "crashes"
    out, err = io.StringIO(), io.StringIO()
    state = os.environ.get("XDG_STATE_HOME")
    os.environ["XDG_STATE_HOME"] = str(folder / "state")
    try:
        os.chdir(folder)
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            status = cli.main(words)
    finally:
        os.chdir(before)
        if state is None:
            del os.environ["XDG_STATE_HOME"]
        else:
            os.environ["XDG_STATE_HOME"] = state
    assert status in (0, 1, 2), (status, words)
    reports = list(crashes.glob("*.txt"))
    assert not reports, (words, reports[0].read_text()[-600:])
    said = out.getvalue() + err.getvalue()
    assert "Traceback" not in said, (words, said[-300:])
    if status == 1 or (status == 2 and words):
        assert said.strip(), words
