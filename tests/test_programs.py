"""Programs are dropped before the process has no memory maps left, and not without need."""

from pathlib import Path

import jax

from kinetix.programs import ProgramRoom


def write_maps(process: Path, count: int) -> None:
    (process / "maps").write_text("7f00-7f01 r-xp 00000000 00:00 0\n" * count)


def test_a_look_now_and_then_drops_programs_where_there_is_hardly_room(tmp_path: Path) -> None:
    now = [100.0]
    room = ProgramRoom(tmp_path, clock=lambda: now[0])
    write_maps(tmp_path, 60_000)
    traced = []
    double = jax.jit(lambda x: traced.append(x) or 2 * x)
    double(1.0)
    assert room.make()
    assert double(1.0) == 2.0 and len(traced) == 2
    assert not room.make(), "just looked"
    now[0] += 10
    assert not room.make(), "what is left is in use"
    write_maps(tmp_path, 64_990)
    now[0] += 10
    assert not room.make()
    write_maps(tmp_path, 65_100)
    now[0] += 10
    assert room.make()


def test_nothing_is_dropped_where_there_is_room_or_no_such_folder(tmp_path: Path) -> None:
    assert not ProgramRoom(tmp_path / "nowhere").make()
    write_maps(tmp_path, 20_000)
    assert not ProgramRoom(tmp_path).make()
