"""Options of the compiler are asked for once, and nobody's own are changed."""

import mmap
import subprocess
import sys
from pathlib import Path

import jax
import jaxlib
import pytest

from kinetix.compiler import ask_for_options, quick_options

OPTION = "xla_cpu_small_while_loop_byte_threshold="
PROGRAM = """
import jax, jax.numpy as jnp
{imports}
loop = lambda x: jax.lax.fori_loop(0, 7, lambda i, x: x * 1.5 + i, x)
print("small_call" in jax.jit(loop).lower(jnp.ones(1000)).compile().as_text())
"""


@pytest.mark.parametrize("before", ["", "--xla_dump_to=somewhere"])
def test_options_are_added_to_what_is_there(before: str) -> None:
    variables = {"XLA_FLAGS": before} if before else {}
    ask_for_options(variables)
    assert variables["XLA_FLAGS"].startswith(before)
    assert OPTION in variables["XLA_FLAGS"]
    once = dict(variables)
    ask_for_options(variables)
    assert variables == once


def test_own_options_of_a_person_stay() -> None:
    theirs = "--xla_backend_extra_options=theirs=1"
    variables = {"XLA_FLAGS": theirs}
    ask_for_options(variables)
    assert variables["XLA_FLAGS"].startswith(theirs)
    assert variables["XLA_FLAGS"].count("--xla_backend_extra_options") == 1
    assert OPTION not in variables["XLA_FLAGS"]


def loops_are_small(imports: str) -> str:
    """Return "True" where a new process compiles a loop into one routine, else "False"."""
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM.format(imports=imports)],
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.strip()


def test_the_compiler_obeys(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("XLA_FLAGS", raising=False)
    monkeypatch.setenv("JAX_PLATFORMS", "cpu")
    assert loops_are_small("import kinetix") == "True"
    monkeypatch.setenv("KINETIX_COMPILER_OPTIONS", "0")
    # Without the options it differs from version to version: as if Kinetix were not there.
    assert loops_are_small("import kinetix") == loops_are_small("")


def test_they_can_be_declined():
    variables = {"KINETIX_COMPILER_OPTIONS": "0", "XLA_FLAGS": "--xla_dump_to=/tmp/x"}
    ask_for_options(variables)
    assert variables["XLA_FLAGS"] == "--xla_dump_to=/tmp/x"
    variables["KINETIX_COMPILER_OPTIONS"] = "1"
    ask_for_options(variables)
    assert "xla_cpu_prefer_vector_width" in variables["XLA_FLAGS"]


@pytest.mark.parametrize("accelerated", [False, True])
def test_a_lower_level_is_asked_for_where_only_processors_are(
    monkeypatch: pytest.MonkeyPatch, accelerated: bool
) -> None:
    found = {"jax_plugins": object()} if accelerated else {}
    monkeypatch.setattr("importlib.util.find_spec", found.get)
    variables: dict[str, str] = {}
    ask_for_options(variables)
    level = "--xla_backend_optimization_level=1"
    assert (level in variables["XLA_FLAGS"].split()) is not accelerated


@pytest.mark.parametrize(("version", "older"), [("0.10.1", True), ("0.11.0", False)])
def test_emitters_are_chosen_for_the_quick_tier_alone_and_where_jax_has_the_choice(
    monkeypatch: pytest.MonkeyPatch, version: str, older: bool
) -> None:
    monkeypatch.setattr("importlib.metadata.version", lambda _: version)
    variables: dict[str, str] = {}
    ask_for_options(variables)
    assert "emitters" not in variables["XLA_FLAGS"]
    quick_options.cache_clear()
    assert ("xla_cpu_use_fusion_emitters" in quick_options()) is older
    monkeypatch.undo()
    quick_options.cache_clear()


def test_this_jax_knows_the_options_of_the_quick_tier():
    """XLA refuses those that it does not know."""
    options = dict(quick_options())
    assert options["xla_backend_optimization_level"] == 0
    assert jax.jit(lambda x: 2 * x, compiler_options=options)(3) == 6


def test_passes_that_are_left_out_are_passes():
    """XLA takes any name without a word."""
    left_out = str(quick_options()["xla_disable_hlo_passes"]).split(",")
    found: set[str] = set()
    for library in Path(jaxlib.__file__).parent.glob("*.so"):
        with library.open("rb") as file, mmap.mmap(file.fileno(), 0, prot=mmap.PROT_READ) as code:
            found |= {name for name in left_out if code.find(name.encode()) >= 0}
    assert found == set(left_out)
