"""Scripted runs: what they do, and how they say that something cannot be done."""

import json
from pathlib import Path

import pytest

from editor.hosts.headless import HeadlessHost
from editor.hosts.replay import Replayer, ReplayError
from editor.session import Session
from editor.worker.jobs import Worker
from editor.worker.requests import Progress, Request
from kinetix.level.codec import load_level, loads
from kinetix.level.validate import validate
from kinetix.paths import levels_dir


@pytest.fixture
def play(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    hosts = []

    def run(*lines: str) -> Session:
        path = tmp_path / "events.jsonl"
        path.write_text("\n".join(lines), encoding="utf-8")
        host = HeadlessHost(Session(worker=Worker()))
        hosts.append(host)
        Replayer(host, path).run()
        return host.session

    yield run
    for host in hosts:
        host.session.worker.stop()
        host.close()


LEVEL = str(levels_dir() / "l" / "rover_ridge.json")
OPEN = json.dumps({"do": "open", "file": LEVEL})


def test_draws_sets_and_saves(play, tmp_path):
    out = tmp_path / "deep" / "out.json"
    session = play(
        '{"do":"tool","id":"circle"}',
        '{"do":"drag","from":[2,2],"to":[2.4,2]}',
        '{"do":"set","field":"density","value":2.0}',
        '{"do":"set","field":"shape.radius","value":0.3}',
        json.dumps({"do": "save", "file": str(out)}),
    )
    (body,) = load_level(out).bodies
    assert (body.density, body.shape.radius) == pytest.approx((2.0, 0.3))
    assert not session.document.dirty


def test_mouse_keys_wheel_and_state(play, tmp_path):
    record = tmp_path / "state.json"
    play(
        OPEN,
        '{"do":"move","world":[2.5,2.5]}',
        '{"do":"wheel","dy":1}',
        '{"do":"down","world":[4.75,1.2]}',
        '{"do":"up"}',
        '{"do":"key","key":"a","mods":["ctrl"]}',
        json.dumps({"do": "state", "file": str(record)}),
    )
    state = json.loads(record.read_text())
    assert set(state) == {
        *("mode", "selection", "dirty", "undo", "redo", "level_hash", "step", "outcome", "fps"),
        "problems",
    }
    assert state["mode"] == "edit" and not state["dirty"]
    assert len(state["selection"]) > 3


def test_text_goes_to_the_field_that_has_the_keyboard(play):
    session = play(
        '{"do":"down","widget":"level.name"}',
        '{"do":"up"}',
        '{"do":"wait","frames":2}',
        '{"do":"key","key":"a","mods":["ctrl"]}',
        '{"do":"text","text":"Typed"}',
        '{"do":"key","key":"return"}',
    )
    assert session.document.level.name == "Typed"


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("nonsense", "not JSON"),
        ('{"do":"dance"}', "unknown event 'dance'"),
        ('{"do":"open","file":"/nowhere/level.json"}', "/nowhere/level.json"),
        ('{"do":"action","id":"edit.explode"}', "edit.explode"),
        ('{"do":"action","id":"edit.delete"}', "disabled"),
        ('{"do":"tool","id":"chisel"}', "unknown tool 'chisel'"),
        ('{"do":"key","key":"hyper"}', "unknown key 'hyper'"),
        ('{"do":"pad","control":"pad z","pressed":true}', "unknown control 'pad z'; there are pad"),
        ('{"do":"pinch","factor":0}', "factor is 0: expected more than 0"),
        ('{"do":"set","field":"density","value":2}', "nothing is selected"),
        ('{"do":"drag","from":[1,1]}', "'to' is missing"),
        ('{"do":"wait","frames":-1}', "frames is -1: expected 0 or more"),
        ('{"do":"hold","key":"left","frames":-1}', "frames is -1: expected 0 or more"),
        ('{"do":"wait_until","what":"idle","seconds":-1}', "seconds is -1: expected 0 or more"),
        ('{"do":"wait_until","what":"playing","seconds":0.1}', "the app is in Edit"),
        ('{"do":"screenshot","file":"a.png"}', "draws no pixels"),
        ('{"do":"agent","dir":"a","slot":"a"}', "nor a bundled agent"),
        ('{"do":["drag"]}', "unknown event ['drag']"),
        ('{"do":"drag","from":[1],"to":[2,3]}', "from is [1]: expected two numbers"),
        ('{"do":"drag","from":[1,2],"to":5}', "to is 5: expected two numbers"),
        ('{"do":"move","world":["a","b"]}', "world is ['a', 'b']: expected two numbers"),
        ('{"do":"move","at":[1,2,3]}', "at is [1, 2, 3]: expected two numbers"),
        ('{"do":"down","button":4}', "button is 4: expected 1, 2 or 3"),
        ('{"do":"up","button":[]}', "button is []: expected 1, 2 or 3"),
        ('{"do":"state","file":"/"}', "state: /: Is a directory"),
        ('{"do":"state","file":"/dev/null/a.json"}', "state: /dev/null: "),
        ('{"do":"save","file":"/dev/null/a.json"}', "save: /dev/null: "),
    ],
)
def test_what_cannot_be_applied_ends_the_run_with_its_line(play, line, said):
    with pytest.raises(ReplayError, match=r"events\.jsonl:2: ") as caught:
        play('{"do":"wait","frames":1}', line)
    assert said in str(caught.value)


def test_a_compile_that_fails_ends_the_wait_with_its_reason(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))

    def fail(request: Request, progress: Progress) -> None:
        raise RuntimeError(f"no memory left for {type(request).__name__}\nand pages of detail")

    path = tmp_path / "events.jsonl"
    path.write_text(
        f'{OPEN}\n{{"do":"key","key":"space"}}\n'
        '{"do":"wait_until","what":"playing","seconds":300}'
    )
    host = HeadlessHost(Session(worker=Worker(perform=fail)))
    try:
        with pytest.raises(ReplayError, match=r"events\.jsonl:3: .*no memory left for Start"):
            Replayer(host, path).run()
        assert host.session.editing
        (toast,) = host.session.toasts
        assert toast.kind == "error" and "pages" not in toast.text
        assert "pages of detail" in host.session.worker.log.lines[0]
    finally:
        host.session.worker.stop()
        host.close()


def test_a_wrong_field_value_is_named(play):
    with pytest.raises(ReplayError, match="density"):
        play(
            OPEN,
            '{"do":"action","id":"edit.select_all"}',
            '{"do":"set","field":"density","value":-1}',
        )


@pytest.mark.slow
def test_from_an_empty_level_to_one_that_is_won(play, script, tmp_path):
    """The path of somebody new, by mouse and keys alone: a car with motors, and a goal."""
    session = play(*script("three_minutes.jsonl").read_text().splitlines())
    states = {
        name: json.loads((tmp_path / f"{name}.json").read_text())
        for name in ("empty", "saved", "played", "stopped")
    }
    assert {"E101", "E102", "W201"} == set(states["empty"]["problems"])
    assert states["saved"]["problems"] == [] and not states["saved"]["dirty"]
    assert states["played"]["outcome"] == "won"
    assert states["stopped"]["level_hash"] == states["saved"]["level_hash"]
    level = load_level(tmp_path / "first_car.json")
    assert validate(level) == ()
    assert [joint.motor.on for joint in level.joints] == [True, True]
    assert [body.role for body in level.bodies] == ["green", "none", "none", "blue"]
    wheels = level.bodies[1:3]
    # Sizes are kept to 1e-5 m, and a point of the screen is as wide as many of them.
    assert [wheel.shape.radius for wheel in wheels] == pytest.approx([0.2, 0.2], abs=2e-5)
    assert session.document.path == tmp_path / "first_car.json"


_BY_HAND = frozenset({"key", "drag", "down", "hold", "text", "wheel"})
"""What a person does: a release ends what a press began, and waiting is no work."""


@pytest.mark.slow
def test_a_newcomer_builds_plays_wins_and_saves_three_machines(play, script, tmp_path):
    """A car over a gap, a catapult with limits, a lander with two thrusters, from nothing."""
    lines = script("newcomer.jsonl").read_text().splitlines()
    assert sum(json.loads(line)["do"] in _BY_HAND for line in lines) <= 90
    play(*lines)
    levels = {}
    for name in ("car", "catapult", "lander"):
        assert json.loads((tmp_path / f"{name}_played.json").read_text())["outcome"] == "won", name
        levels[name] = load_level(tmp_path / f"{name}_level.json")
        assert not [each for each in validate(levels[name]) if each.severity == "error"]
    car, catapult, lander = levels.values()
    assert len(car.joints) == 2 and all(joint.motor.on for joint in car.joints)
    left, right = (body for body in car.bodies[:2])
    assert right.position[0] - left.position[0] > 0
    assert catapult.joints[0].limits is not None and catapult.joints[0].motor.speed == 4.0
    assert [thruster.binding for thruster in lander.thrusters] == [0, 0]


@pytest.mark.slow
def test_draws_undoes_redoes_plays_stops_and_saves(play, script, tmp_path):
    peer = Path(__file__).resolve().parents[4] / "shared" / "peer" / "levels" / "l"
    file = peer / "h1_car_left.json"
    # In both there is nothing near that the circle's edge could snap to.
    level_file = file if file.is_file() else levels_dir() / "m" / "keyhole.json"
    lines = script("first_circle.jsonl").read_text().splitlines()
    play(json.dumps({"do": "open", "file": str(level_file)}), *lines)
    states = {
        name: json.loads((tmp_path / f"{name}.json").read_text())
        for name in ("drawn", "undone", "redone", "played", "stopped")
    }
    opened = load_level(level_file)
    assert states["undone"]["redo"] is not None and not states["undone"]["dirty"]
    assert states["drawn"]["level_hash"] == states["redone"]["level_hash"]
    assert states["played"]["step"] >= 55 or states["played"]["outcome"] is not None
    assert states["stopped"]["mode"] == "edit"
    assert states["stopped"]["level_hash"] == states["drawn"]["level_hash"]
    saved = loads((tmp_path / "saved.json").read_text(), "saved.json")
    assert saved.bodies[: len(opened.bodies)] == opened.bodies
    assert len(saved.bodies) == len(opened.bodies) + 1
    assert saved.bodies[-1].shape.radius == pytest.approx(0.3, abs=0.01)
    # kinetix-env's format has no ids: reading numbers bodies, then joints, anew.
    unnumbered = [[joint.replace(id=1) for joint in level.joints] for level in (saved, opened)]
    assert unnumbered[0] == unnumbered[1]
    assert (saved.gravity, saved.arena) == (opened.gravity, opened.arena)
