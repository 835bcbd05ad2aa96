"""Programs are compiled in threads of their own: who waits may leave, what is unwanted ends."""

import errno
import itertools
import os
import threading
import time
from pathlib import Path

import pytest

from editor.worker.bridge import keep_what_was_compiled
from editor.worker.requests import Cancelled
from editor.worker.simulation import disk
from editor.worker.simulation.compiling import FULL, QUICK, Pace, Programs, Recipe, slowing
from kinetix.compiler import quick_options
from tests.editor.core.helpers import Unheard


class Stages:
    """A program that is traced, lowered and compiled when it is let."""

    def __init__(self, *, held=True):
        self.traced, self.going_on = threading.Event(), threading.Event()
        self.done, self.options = [], []
        if not held:
            self.going_on.set()

    def trace(self):
        self.done.append("trace")
        self.traced.set()
        assert self.going_on.wait(120)
        return self

    def lower(self):
        self.done.append("lower")
        return self

    def compile(self, compiler_options):
        self.done.append("compile")
        self.options.append(compiler_options)
        return self


class Leaving:
    """Stays for some looks, then is not interested any more; remembers what it was told."""

    def __init__(self, looks):
        self.looks, self.told = looks, []

    def report(self, fraction, message):
        self.told.append((fraction, message))
        if len(self.told) > self.looks:
            raise Cancelled


def recipe(stages, tier=FULL):
    return Recipe(key="it", tier=tier, trace=stages.trace)


def until(condition):
    end = time.monotonic() + 120
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.005)


def test_the_quick_tier_asks_the_compiler_for_less_and_is_kept():
    stages, programs = Stages(held=False), Programs()
    assert programs.obtain(recipe(stages, QUICK), Unheard()) is stages
    assert stages.options == [quick_options()]
    assert programs.obtain(recipe(stages, QUICK), Unheard()) is stages
    assert stages.done == ["trace", "lower", "compile"]
    assert programs.taken_fresh() == [("it", stages)]
    assert programs.taken_fresh() == []


def test_who_is_called_off_leaves_at_once_and_what_nobody_wants_gives_up():
    stages, programs = Stages(), Programs()
    with pytest.raises(Cancelled):
        programs.obtain(recipe(stages), Leaving(2))
    assert "lower" not in stages.done, "it does not wait for the stage to end"
    stages.going_on.set()
    until(lambda: not programs._coming)
    assert stages.done == ["trace"]
    assert programs.get("it") is None


def test_who_comes_later_takes_it_over():
    stages, programs, got = Stages(), Programs(), []
    thread = threading.Thread(target=lambda: got.append(programs.obtain(recipe(stages), Unheard())))
    with pytest.raises(Cancelled):
        programs.obtain(recipe(stages), Leaving(0))
    thread.start()
    until(lambda: any(coming.waiting for coming in programs._coming.values()))
    stages.going_on.set()
    thread.join(120)
    assert got == [stages]
    assert stages.done == ["trace", "lower", "compile"], "once"


def test_it_tells_what_it_does_and_how_far_it_is(monkeypatch):
    monkeypatch.setattr(Pace, "seconds", 10.0)
    stages, programs, progress = Stages(), Programs(), Leaving(8)
    with pytest.raises(Cancelled):
        programs.obtain(recipe(stages), progress)
    stages.going_on.set()
    fractions = [fraction for fraction, _ in progress.told]
    assert fractions == sorted(fractions) and fractions[-1] > fractions[0]
    assert fractions[0] >= 0 and fractions[-1] < 0.1, "tracing is a small part"
    assert {message for _, message in progress.told} == {"Reading the physics"}


def test_an_error_reaches_everybody_and_the_next_one_tries_again():
    def fails():
        raise ValueError("no such thing")

    programs = Programs()
    bad = Recipe(key="it", tier=FULL, trace=fails)
    for _ in range(2):
        with pytest.raises(ValueError, match="no such thing"):
            programs.obtain(bad, Unheard())
    assert programs.obtain(recipe(Stages(held=False)), Unheard())


def test_in_the_background_one_is_compiled_at_a_time():
    programs, first, second = Programs(), Stages(), Stages(held=False)
    other = Recipe(key="other", tier=FULL, trace=second.trace)
    threads = [
        threading.Thread(
            target=programs.obtain, args=(each, Unheard()), kwargs={"background": True}
        )
        for each in (recipe(first), other)
    ]
    threads[0].start()
    assert first.traced.wait(120)
    threads[1].start()
    until(lambda: "other" in programs._coming)
    time.sleep(0.2)
    assert second.done == []
    urgent = Recipe(key="urgent", tier=QUICK, trace=Stages(held=False).trace)
    programs.obtain(urgent, Unheard())  # somebody who waits is not held up
    first.going_on.set()
    for thread in threads:
        thread.join(120)
    assert second.done == ["trace", "lower", "compile"]


@pytest.fixture
def cache(tmp_path, monkeypatch):
    monkeypatch.setattr(disk, "cache_folder", lambda name: tmp_path / name)
    return tmp_path


def doubling():
    """Return a compiled program, arguments of it, and a tree like its results."""
    import jax
    import numpy as np

    # No other run has left it in JAX's cache, from which programs come without all of their code.
    own = int.from_bytes(os.urandom(3))

    def double(x, y):
        return {"sum": x["a"] + y, "own": own * y}

    arguments = ({"a": jax.device_put(np.ones(3))}, jax.device_put(np.arange(3.0)))
    program = jax.jit(double).lower(*arguments).compile()
    return program, arguments, {"sum": 0, "own": 0}


def test_a_program_comes_back_from_disk_and_a_broken_one_is_thrown_away(cache):
    program, arguments, results = doubling()
    assert disk.load("double", arguments, results) is None
    disk.save("double", program)
    assert disk.has("double") and not disk.has("triple")
    loaded = disk.load("double", arguments, results)
    assert loaded(*arguments)["sum"].tolist() == [1.0, 2.0, 3.0]
    (path,) = (cache / "steps").iterdir()
    path.write_bytes(path.read_bytes()[:-20])
    assert disk.load("double", arguments, results) is None
    assert not disk.has("double")


def test_steps_are_written_when_the_app_is_left(cache, monkeypatch):
    from editor.worker.simulation import stepping
    from kinetix import StaticEnvParams

    key = stepping.StepKey(static=StaticEnvParams(), tier=QUICK)
    monkeypatch.setattr(stepping.PROGRAMS, "fresh", [(key, doubling()[0])])
    monkeypatch.setattr(stepping, "tidy_caches", lambda: None)
    keep_what_was_compiled()
    assert disk.has(key)
    assert not stepping.PROGRAMS.fresh


def test_programs_come_back_from_a_cache_that_can_only_be_read(cache, monkeypatch):
    def refuse(*_, **__):
        raise PermissionError(errno.EROFS, os.strerror(errno.EROFS))

    program, arguments, results = doubling()
    disk.save("double", program)
    (path,) = (cache / "steps").iterdir()
    monkeypatch.setattr(os, "utime", refuse)
    monkeypatch.setattr(Path, "unlink", refuse)
    loaded = disk.load("double", arguments, results)
    assert loaded(*arguments)["sum"].tolist() == [1.0, 2.0, 3.0]
    path.write_bytes(path.read_bytes()[:-20])
    assert disk.load("double", arguments, results) is None


def test_progress_follows_the_usual_duration_and_then_never_stands_still():
    shares = [slowing(k / 10) for k in range(60)]
    assert shares[:8] == [k / 10 for k in range(8)]
    assert all(later - now > 0.0005 for now, later in itertools.pairwise(shares[:40]))
    assert shares[20] < 0.96 and shares[-1] < 1
