"""Kernels on disk: what comes from there is the same, and whatever is wrong there is made anew."""

import contextlib
import dataclasses
import enum
import functools
import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.engine import actuators, constants
from kinetix.engine.batch import lowered, worlds_last
from kinetix.engine.batch.described import NotOurs, described
from kinetix.engine.spec import Capacity


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """An empty cache folder, and nothing kept in memory."""
    monkeypatch.setattr("kinetix.files.caches.cache_dir", lambda: tmp_path)
    lowered._lowered.cache_clear()
    yield tmp_path / "lowered"
    lowered._lowered.cache_clear()


def many(factor: float = 2.0):
    """A program of three worlds, made anew as another process would."""

    def kernel(x):
        return {"out": factor * x, "sum": jnp.sum(x, 0)}

    lowered._lowered.cache_clear()
    return jax.jit(jax.vmap(worlds_last(kernel, made_of=("test", factor))))


VALUES = np.arange(12, dtype=np.float32).reshape(3, 4)


def check(result) -> None:
    np.testing.assert_array_equal(result["out"], 2 * VALUES)
    np.testing.assert_array_equal(result["sum"], VALUES.sum(1))


def test_the_next_process_neither_traces_nor_lowers(folder, monkeypatch) -> None:
    made, export = [], lowered.export.export

    def counted(run, **options):
        made.append(run)
        return export(run, **options)

    monkeypatch.setattr(lowered.export, "export", counted)
    check(many()(VALUES))
    check(many()(VALUES))
    assert len(made) == len(list(folder.iterdir())) == 1
    many()(VALUES[:2])  # other shapes are another program
    many(3.0)(VALUES)
    assert len(made) == len(list(folder.iterdir())) == 3


def test_a_constant_that_somebody_changes_is_another_program(folder, monkeypatch) -> None:
    check(many()(VALUES))
    monkeypatch.setattr(constants, "TAUT", 2 * constants.TAUT)
    check(many()(VALUES))
    assert len(list(folder.iterdir())) == 2


@pytest.mark.parametrize("changed", [functools.wraps, lambda _: lambda f: f, lambda _: jax.jit])
def test_what_a_replaced_function_makes_is_not_kept(folder, monkeypatch, changed) -> None:
    @changed(actuators.motor_fade)
    def motor_fade(*_):
        return 1.0

    monkeypatch.setattr(actuators, "motor_fade", motor_fade)
    check(many()(VALUES))
    assert not folder.exists()


@pytest.mark.parametrize("damage", [b"", b"\x78\x01damaged", None])
def test_a_file_that_is_not_whole_is_written_anew(folder, damage) -> None:
    check(many()(VALUES))
    (file,) = folder.iterdir()
    whole = file.read_bytes()
    file.write_bytes(whole[: len(whole) // 2] if damage is None else damage)
    check(many()(VALUES))
    check(many()(VALUES))
    assert len(list(folder.iterdir())) == 1 and len(file.read_bytes()) > len(whole) // 2


def test_a_folder_that_cannot_be_made_is_done_without(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("kinetix.files.caches.cache_dir", lambda: tmp_path / "file")
    (tmp_path / "file").write_text("in the way")
    check(many()(VALUES))


def test_who_declines_jaxs_cache_declines_this_one(folder) -> None:
    before = jax.config.values["jax_enable_compilation_cache"]
    jax.config.update("jax_enable_compilation_cache", False)
    try:
        check(many()(VALUES))
    finally:
        jax.config.update("jax_enable_compilation_cache", before)
    assert not folder.exists()


@pytest.mark.parametrize("first_in_a_mesh", [True, False])
def test_a_mesh_of_the_caller_is_not_kept(folder, first_in_a_mesh) -> None:
    devices = np.array(jax.devices()[:1])
    mesh = jax.sharding.Mesh(devices, ("d",), axis_types=(jax.sharding.AxisType.Auto,))
    for in_a_mesh in (first_in_a_mesh, not first_in_a_mesh):
        with jax.set_mesh(mesh) if in_a_mesh else contextlib.nullcontext():
            check(many()(VALUES))
    assert len(list(folder.iterdir())) == 1


def test_what_no_file_can_hold_is_lowered_as_ever(folder, monkeypatch) -> None:
    def refuse(*_, **__):
        raise NotImplementedError("serialization of host_callbacks")

    monkeypatch.setattr(lowered.export, "export", refuse)
    check(many()(VALUES))
    assert not folder.exists()


def test_without_a_way_to_write_it_it_is_used_in_this_process(folder, monkeypatch) -> None:
    def refuse(*_, **__):
        raise ImportError("Please install 'flatbuffers'")

    monkeypatch.setattr(lowered.export.Exported, "serialize", refuse)
    check(many()(VALUES))
    assert not folder.exists()


def test_who_keeps_nothing_keeps_no_kernels(folder) -> None:
    name = "jax_persistent_cache_min_compile_time_secs"
    before = jax.config.values[name]
    jax.config.update(name, math.inf)
    try:
        check(many()(VALUES))
    finally:
        jax.config.update(name, before)
    assert not folder.exists()


def test_a_program_for_two_kinds_of_machine_is_lowered_as_ever(folder) -> None:
    both = many().trace(VALUES).lower(lowering_platforms=("cpu", "cuda"))
    assert "stablehlo" in both.as_text()
    assert not folder.exists()


def test_wide_numbers_are_another_program(folder) -> None:
    check(many()(VALUES))
    with jax.enable_x64(True):
        check(many()(VALUES))
    assert len(list(folder.iterdir())) == 2


def test_words_say_all_about_our_own_values() -> None:
    assert described(("a", 1.5, None, Capacity(polygons=4, circles=1, joints=0, thrusters=0))) == (
        "('a', 1.5, None, kinetix.engine.spec.Capacity("
        "polygons=4, circles=1, joints=0, thrusters=0))"
    )


@dataclasses.dataclass(frozen=True)
class _Theirs:
    number: int = 1


class _Kind(enum.Enum):
    ONE = 1


@pytest.mark.parametrize("value", [_Theirs(), _Kind.ONE, [1], np.float32(1), (1, (_Theirs(),))])
def test_there_are_no_words_for_what_somebody_may_change(value) -> None:
    with pytest.raises(NotOurs):
        described(value)


def test_a_kernel_of_somebody_else_is_not_kept(folder) -> None:
    run = jax.jit(jax.vmap(worlds_last(lambda x: x + 1, made_of=("test", _Theirs()))))
    np.testing.assert_array_equal(run(VALUES), VALUES + 1)
    assert not folder.exists()
