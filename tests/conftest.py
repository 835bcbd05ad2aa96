"""Settings of all tests: strict JAX, quick compilation and a persistent compile cache."""

import collections
import gc
import os
import signal
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from kinetix.compiler import quick_options
from kinetix.memory import give_back_memory

os.environ.setdefault("JAX_PLATFORMS", "cpu")
# The user's own caches stay as they are.
_CACHES = Path.home() / ".cache" / "kinetix-tests"
os.environ.setdefault("XDG_CACHE_HOME", str(_CACHES))
os.environ.setdefault("JAX_COMPILATION_CACHE_DIR", str(_CACHES / "jax"))
os.environ.setdefault("JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS", "0.3")
# The suite has a process a core already.
os.environ.setdefault("KINETIX_CORES", "1")
# Most tests compile for seconds to run for milliseconds.
os.environ.setdefault("JAX_DISABLE_MOST_OPTIMIZATIONS", "1")
# So each program is compiled as one that somebody waits for, but for its level: jitted parts of a
# program take the process's flags alone.
_QUICK_TO_COMPILE = [
    f"--{option}={str(value).lower()}"
    for option, value in quick_options().items()
    if option != "xla_backend_optimization_level"
]
_flags = os.environ.get("XLA_FLAGS", "").split()  # a worker of xdist's has ours already
os.environ["XLA_FLAGS"] = " ".join(dict.fromkeys([*_flags, *_QUICK_TO_COMPILE]))
# `nohup make test` would leave it ignored, here and in children that are to end by it.
signal.signal(signal.SIGHUP, signal.SIG_DFL)
# Tracing makes many objects and next to no garbage: collected seldom, it takes a quarter less.
gc.set_threshold(100_000, 50, 100)

PEER = Path(__file__).resolve().parents[2] / "shared" / "peer"
"""Folder of kinetix-env's data, for developers; a user has none."""


_SLOW_SECONDS = 10
"""What a slow test takes that does not say more: `@pytest.mark.slow(seconds=100)`."""


@pytest.fixture(scope="session")
def peer() -> Path:
    """Folder of kinetix-env's data; tests that need it are skipped where it is absent."""
    if not PEER.is_dir():
        pytest.skip("kinetix-env's data is not here")
    assert any((PEER / "levels").rglob("*.json")), f"{PEER}/levels holds no level"
    return PEER


@pytest.fixture
def fully_optimised(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let child processes compile as users do: for tests that are about bits or speed."""
    monkeypatch.delenv("JAX_DISABLE_MOST_OPTIMIZATIONS", raising=False)
    flags = [flag for flag in os.environ["XLA_FLAGS"].split() if flag not in _QUICK_TO_COMPILE]
    monkeypatch.setenv("XLA_FLAGS", " ".join(flags))


@pytest.fixture(name="optimised")
def _optimised() -> Iterator[None]:
    """Compile as users do: for tests that compute much longer than they compile."""
    from tests.optimised import optimised

    with optimised():
        yield


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put the files that take longest first, so that no worker waits for one at the end."""
    seconds = collections.Counter()
    for item in items:
        slow = item.get_closest_marker("slow")
        seconds[item.path] += slow.kwargs.get("seconds", _SLOW_SECONDS) if slow else 0
    items.sort(key=lambda item: -seconds[item.path])


@pytest.fixture(autouse=True, scope="module")
def _bounded_memory():
    """Compiled functions pile up over a whole run: drop them once the process has grown large.

    Each brings memory maps of its own, and a process may have 65 530 of them; one more, and reading
    a compiled function from the cache crashes.
    """
    yield
    process = Path("/proc/self")
    if not process.is_dir() or "jax" not in sys.modules:
        return
    resident = int((process / "statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    maps = (process / "maps").read_bytes().count(b"\n")
    if resident > 4 * 2**30 or maps > 20_000:
        sys.modules["jax"].clear_caches()
        gc.unfreeze()  # the editor exempts what it compiles from collections
        gc.collect()
        give_back_memory()  # else the process stays large, and is cleared ever anew
