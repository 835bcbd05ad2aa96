import dataclasses
import importlib.util
import itertools
import json
import math
import os
import sys
from pathlib import Path

import jax.numpy as jnp
import numpy as np
import pytest

from kinetix import cli
from kinetix.bench import processes
from kinetix.bench.accuracy import row_of
from kinetix.bench.peers import launch, levels
from kinetix.bench.peers import scenes as peer_scenes
from kinetix.bench.peers.accuracy import UNSAID, judged, measure_peer
from kinetix.bench.peers.catalogue import PEERS, SLOW, SWEPT, peer_named
from kinetix.bench.peers.exchange import motion_of, scene_of
from kinetix.bench.peers.launch import Answer, Peer, PeerLateError, ask
from kinetix.bench.peers.store import chosen_peers
from kinetix.bench.report import markdown_table, scene_text
from kinetix.errors import KinetixError
from kinetix.level.codec import load_level
from kinetix.paths import levels_dir
from kinetix.scenes import SCENES
from kinetix.scenes.model import Trial

PROGRAMS = Path(launch.PROGRAMS)

TOY = f"""
import sys
sys.path.insert(0, {str(PROGRAMS)!r})
from protocol import UnsaidError, serve

class Ballistic:
    '''Exact flight; refuses joints.'''
    def __init__(self, scene, settings):
        if scene["joints"]:
            raise UnsaidError("joints")
        self.scene, self.k = scene, 0
    def step(self):
        self.k += 1
    def state(self):
        t, (gx, gy) = self.k * self.scene["dt"], self.scene["gravity"]
        return [
            (b["position"][0] + b["velocity"][0] * t + gx * t * t / 2,
             b["position"][1] + b["velocity"][1] * t + gy * t * t / 2,
             b["angle"] + b["angular_velocity"] * t,
             b["velocity"][0] + gx * t, b["velocity"][1] + gy * t, b["angular_velocity"])
            for b in self.scene["bodies"][: self.scene["recorded"]]
        ]

serve(Ballistic, "1.0")
"""


@pytest.fixture
def toy(tmp_path, monkeypatch):
    """An engine of a few lines in an environment that is this one."""
    (tmp_path / "toy" / "bin").mkdir(parents=True)
    python = tmp_path / "toy" / "bin" / "python"
    python.write_text(f'#!/bin/sh\nexec "{sys.executable}" "$@"\n')
    python.chmod(0o755)
    (tmp_path / "toy.py").write_text(TOY)
    monkeypatch.setattr(launch, "ENVIRONMENTS", tmp_path)
    monkeypatch.setattr(launch, "PROGRAMS", tmp_path)
    return Peer(name="toy", family="toy", environment="toy", program="toy.py", settings={})


BATCHED = f"""
import sys
sys.path.insert(0, {str(PROGRAMS)!r})
import jax.numpy as jnp
from jax_scenes import serve_compiled
from protocol import UnsaidError

class Spinning:
    '''Bodies that turn evenly; angles as engines in three dimensions know them.'''
    def __init__(self, scene, settings):
        if scene["thrusters"]:
            raise UnsaidError("thrusters")
        self.given = {{"bodies": [
            [*b["position"], b["angle"], *b["velocity"], b["angular_velocity"]]
            for b in scene["bodies"][: scene["recorded"]]
        ], "dt": scene["dt"]}}
    def begin(self, given):
        rows = given["bodies"]
        return jnp.stack([jnp.stack([jnp.float32(x) for x in row]) for row in rows])
    def advance(self, given, state):
        return state.at[:, :3].add(state[:, 3:] * given["dt"])
    def seen(self, given, state):
        angle = state[:, 2]
        return state.at[:, 2].set(jnp.arctan2(jnp.sin(angle), jnp.cos(angle)))

serve_compiled(Spinning, "jax")
"""


@pytest.fixture
def batched(toy, tmp_path):
    """The same for an engine in JAX."""
    (tmp_path / "batched.py").write_text(BATCHED)
    return dataclasses.replace(toy, name="batched", program="batched.py", compiled=True)


def program(name):
    spec = importlib.util.spec_from_file_location(name, PROGRAMS / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    sys.path.insert(0, str(PROGRAMS))
    try:
        spec.loader.exec_module(module)
    finally:
        sys.path.remove(str(PROGRAMS))
    return module


def protocol():
    return program("protocol")


def test_scene_says_masses_friction_and_what_hangs_together():
    (trial,) = SCENES["D10"].make_trials()
    scene = json.loads(json.dumps(scene_of(trial)))
    floor, chassis, *wheels = scene["bodies"]
    assert (floor["mass"], floor["inertia"], floor["group"]) == (0, 0, 0)
    assert chassis["mass"] == pytest.approx(1.24 * 0.284)
    assert chassis["friction"] == pytest.approx(0.566)
    assert [body["radius"] for body in wheels] == pytest.approx([0.2, 0.2])
    assert wheels[0]["inertia"] == pytest.approx(math.pi * 0.2**4 / 2)
    assert {body["group"] for body in (chassis, *wheels)} == {chassis["group"]} != {0}
    assert [(joint["a"], joint["b"], joint["motor"]) for joint in scene["joints"]] == [
        (1, 2, [1.0, 1.0]),
        (1, 3, [1.0, 1.0]),
    ]
    assert (scene["recorded"], scene["steps"], scene["motor"]) == (4, 180, 1.0)


def test_peers_own_inertia_is_half_that_of_a_disc():
    trial = SCENES["F5"].make_trials()[0]
    true, own = (scene_of(trial, inertia=rule)["bodies"][1] for rule in ("exact", "kinetix"))
    assert own["inertia"] == pytest.approx(true["inertia"] / 2)
    assert own["mass"] == pytest.approx(true["mass"])


def test_arena_is_told_of_levels_and_not_of_scenes():
    (trial,) = SCENES["I2"].make_trials()
    assert len(scene_of(trial)["bodies"]) == 1
    level = load_level(levels_dir() / "s" / "goalkeeper.json")
    scene = scene_of(Trial(level=level, duration=1.0))
    assert len(scene["bodies"]) == len(level.bodies) + 4
    assert all(body["mass"] == 0 for body in scene["bodies"][-4:])
    assert scene["recorded"] == len(level.bodies)


def test_exact_flight_is_good_and_what_cannot_be_said_has_no_verdict(toy):
    rows = {row["scene"]: row for row in measure_peer(toy, "I1,I2,D2,R5")}
    assert (rows["I1"]["verdict"], rows["I2"]["verdict"]) == ("good", "good")
    assert rows["I2"]["value"] < 1e-6
    assert (rows["D2"]["metric"], rows["D2"]["value"], rows["D2"]["verdict"]) == (
        UNSAID, None, None,
    )  # fmt: skip
    assert rows["R5"]["verdict"] is None
    assert rows["I2"]["physics"] == "toy"
    table = markdown_table({"toy": list(rows.values())})
    assert "| D2 pendulum ● | – |" in table
    assert scene_text(rows["D2"]).split()[-4:] == ["–", "cannot", "be", "said"]


def test_scene_that_compares_runs_is_judged_whole_or_not_at_all():
    scene = SCENES["R1"]
    trials = scene.make_trials()
    motions = {}
    for k in (0, 1, 2):
        body = scene_of(trials[k])["recorded"]
        motions[f"R1/{k}"] = np.zeros((trials[k].steps + 1, body, 6))
    (metric,) = judged(scene, Answer(told={}, motions=motions))
    assert metric.name == UNSAID


def test_scene_said_in_part_is_judged_by_that_part():
    scene = SCENES["D2"]
    trial = scene.make_trials()[0]
    rows = np.zeros((trial.steps + 1, 2, 6))
    found = judged(scene, Answer(told={}, motions={"D2/0": rows}))
    assert {metric.variant for metric in found} == {"45°", ""}
    assert found[-1].name == "share of runs that cannot be said"
    assert found[-1].value == 0.5
    assert row_of(scene, "p", found)["verdict"] == "fail"


def test_motion_keeps_the_order_of_columns():
    (trial,) = SCENES["I2"].make_trials()
    motion = motion_of(trial, np.arange(12.0).reshape(2, 1, 6))
    assert motion.position[1, 0].tolist() == [6, 7]
    assert (motion.rotation[1, 0], motion.angular_velocity[1, 0]) == (8, 11)
    assert motion.velocity[1, 0].tolist() == [9, 10]


def test_times_are_those_of_the_steps(toy):
    trial = SCENES["I2"].make_trials()[0]
    found = levels.native_speed(toy, [trial])
    assert found["version"] == "1.0"
    assert found["steps_per_s"] > 1e4
    assert 0 < found["call_s"] < 1e-3
    with pytest.raises(KinetixError, match="could say none"):
        levels.native_speed(toy, [SCENES["D2"].make_trials()[0]])


def test_the_median_over_levels_counts(monkeypatch):
    told = {"version": "1", "call_s": 0.0, "seconds_per_step": {"a": 0.1, "b": 0.2, "c": 9.0}}
    monkeypatch.setattr(levels, "ask", lambda *of: Answer(told=told, motions={}))
    assert levels.native_speed(Peer, [])["steps_per_s"] == 5.0


def test_failures_of_a_peer_are_said_in_its_words(toy, monkeypatch):
    with pytest.raises(KinetixError, match="toy: its program ended with 1: KeyError: 'dance'"):
        ask(toy, {"task": "dance"})
    monkeypatch.setattr(launch, "ENVIRONMENTS", Path("/nowhere"))
    with pytest.raises(KinetixError, match="toy is not installed: run `make bench-peers`"):
        ask(toy, {"task": "record", "sets": {}})


def test_peers_that_hang_are_left_out(toy, tmp_path, monkeypatch):
    (tmp_path / "toy.py").write_text("import time\ntime.sleep(60)\n")
    with pytest.raises(PeerLateError, match=r"toy: no answer within 0\.2 s"):
        ask(toy, {"task": "time"}, seconds=0.2)
    monkeypatch.setattr(peer_scenes, "PATIENCE", 0.2)
    (trial,) = SCENES["I2"].make_trials()
    assert peer_scenes._compiled(toy, trial, 1, 1) is None


def test_names_of_peers(capsys):
    names = [peer.name for peer in (*PEERS, *SWEPT, *SLOW)]
    assert len(set(names)) == len(names)
    assert peer_named("box2d dt/2").settings["substeps"] == 2
    assert chosen_peers("none") == ()
    assert [peer.name for peer in chosen_peers("pymunk, box2d")] == ["pymunk", "box2d"]
    for words in (
        ["accuracy", "--peer", "havok"],
        ["peers", "--sizes", "none", "--chart", "havok"],
    ):
        assert cli.main(["bench", *words]) == 1
        assert "unknown peer 'havok': expected one of jax2d," in capsys.readouterr().err


def test_motor_law():
    law = protocol().motor_law
    joint = {"motor": [1.0, 2.0], "limits": None}
    assert law(joint, 1.0, 0.0, 0.0) == pytest.approx(1800 * math.tanh(0.6))
    assert law(joint, 1.0, 0.0, 6.0) == pytest.approx(0)
    assert law(joint, -1.0, 0.0, 0.0) == pytest.approx(-1800 * math.tanh(0.6))
    limited = joint | {"limits": [-1.0, 1.0]}
    assert law(limited, 1.0, 0.95, 0.0) == pytest.approx(900 * math.tanh(0.6))
    assert law(limited, 1.0, 1.2, 0.0) == 0
    # Away from a limit it pulls as ever.
    assert law(limited, -1.0, 1.2, 0.0) == pytest.approx(-1800 * math.tanh(0.6))


def test_motors_between_fixed_bodies_resist_nothing():
    module = protocol()
    heavy, light, fixed = ({"inertia": x, "mass": x} for x in (3.0, 1.5, 0.0))
    assert module.axial_inertia(heavy, light) == pytest.approx(1.0)
    assert module.axial_inertia(heavy, fixed) == pytest.approx(3.0)
    assert module.axial_inertia(fixed, fixed) == 0
    scene = {"bodies": [fixed, fixed, heavy]}
    assert module.both_fixed(scene, {"a": 0, "b": 1})
    assert module.both_fixed(scene, {"a": 2, "b": 2})
    assert not module.both_fixed(scene, {"a": 0, "b": 2})


def test_traced_motor_law_is_the_same():
    law, traced = protocol().motor_law, program("jax_scenes").motor_law
    for limits in (None, [-1.0, 1.0]):
        joint = {"motor": [0.7, 1.5], "limits": limits}
        for action, angle, speed in itertools.product((-1.0, 0.4), (-1.05, 0.2, 0.97), (-2.0, 9.0)):
            found = float(traced(joint, action, jnp.float32(angle), jnp.float32(speed)))
            assert found == pytest.approx(law(joint, action, angle, speed), rel=1e-4, abs=1e-2)


def test_thrust_turns_with_the_body():
    told = {"position": [-0.3, 0.0], "angle": math.pi / 2, "power": 0.02}
    push = program("jax_scenes").thrust(told, 1.0, jnp.float32(math.pi / 2))
    # Along the body's own +y, which looks to -x now, at an arm of -.3 m along its x.
    assert np.asarray(push).tolist() == pytest.approx([-0.2, 0.0, -0.06], abs=1e-6)


def test_bodies_hang_as_a_tree():
    tree_of = program("link_tree").tree_of

    def links(scene):
        return tree_of(json.loads(json.dumps(scene_of(SCENES[scene].make_trials()[0]))))

    chain = links("D3")
    assert [(link.index, link.parent, link.sign) for link in chain] == [(1, None, 1), (2, 1, 1)]
    assert chain[0].holder == 0
    assert chain[1].origin == chain[1].joint["anchor_b"]
    assert chain[1].pin == chain[1].joint["anchor_a"]
    car = links("D10")
    assert [(link.index, link.parent) for link in car] == [(1, None), (2, 1), (3, 1)]
    assert car[0].joint is None
    assert car[0].origin == [0.0, 0.0]
    # A chain may be told from its free end on: parents come first all the same.
    free, fixed = {"mass": 1.0}, {"mass": 0.0}
    pin = {"anchor_a": [0.1, 0.0], "anchor_b": [-0.1, 0.0]}
    joints = [{"a": 0, "b": 1} | pin, {"a": 1, "b": 2} | pin]
    turned = tree_of({"bodies": [free, free, fixed], "joints": joints})
    assert [(link.index, link.parent, link.holder) for link in turned] == [(1, None, 2), (0, 1, 1)]
    assert turned[0].sign == -1
    assert turned[0].origin == [0.1, 0.0]
    for loop in ("D6", "D9"):
        with pytest.raises(Exception, match="joints that close a loop"):
            links(loop)


def test_batched_scenes_run_together_and_angles_do_not_jump(batched):
    trials = [*SCENES["B4"].make_trials()[:2], *SCENES["I3"].make_trials()]
    scenes = [scene_of(trial) for trial in (*trials, SCENES["I4"].make_trials()[0])]
    answer = ask(batched, {"task": "record", "sets": {"T": scenes}})
    assert answer.told["unsaid"] == {"T/3": "UnsaidError: thrusters"}
    assert set(answer.motions) == {"T/0", "T/1", "T/2"}
    for index, scene in enumerate(scenes[:3]):
        rows = answer.motions[f"T/{index}"]
        assert rows.shape == (scene["steps"] + 1, scene["recorded"], 6)
        seconds = scene["steps"] * scene["dt"]
        for body, row in zip(scene["bodies"], rows[-1], strict=True):
            place = body["position"][0] + seconds * body["velocity"][0]
            assert row[0] == pytest.approx(place, abs=1e-4)
            assert row[2] == pytest.approx(seconds * body["angular_velocity"], abs=2e-3)
    assert answer.motions["T/2"][-1, 0, 2] > 90


def test_batched_engines_are_timed_where_they_have_words(batched):
    (trial,) = SCENES["I2"].make_trials()
    rate = peer_scenes._compiled(batched, trial, os.cpu_count(), os.cpu_count())
    assert rate.steps_per_s > 1e3
    assert rate.devices == os.cpu_count()
    (trial,) = SCENES["I4"].make_trials()
    assert peer_scenes._compiled(batched, trial, 1, 1) is None


def test_ratios_compare_like_with_like():
    def row(engine, rate, **fields):
        given = {"what": "env", "size": "s", "batch": 1024, "devices": 1, "compile_s": 1.0}
        return {"engine": engine, "steps_per_s": rate, **given, **fields}

    rows = [
        row("kinetix", 80.0),
        row("kinetix-env", 10.0),
        row("kinetix-env", 10.0, size="m"),
        row("kinetix", 30.0, what="engine"),
        row("box2d", 60.0, what="engine", batch=1, compile_s=None),
    ]
    found = list(levels.ratios(rows))
    assert [(r["against"], r["what"], r["ratio"]) for r in found] == [
        ("kinetix-env", "env", 8.0),
        ("box2d", "engine", 0.5),
    ]


def test_levels_are_measured_in_turn(monkeypatch):
    asked = []

    monkeypatch.setenv("XLA_FLAGS", "--xla_of_ours")

    def answer(peer, job, variables):
        assert variables["XLA_FLAGS"].startswith("--xla_of_ours ")  # it is timed under them, too
        asked.append((peer.name, job["what"], job["batch"], variables["XLA_FLAGS"][-1]))
        assert all(json.loads(Path(file).read_text())["env_state"] for file in job["files"])
        told = {"version": "3", "devices": 1, "seconds_per_step": 0.1, "compile_s": 1.0}
        return Answer(told=told, motions={})

    def apart(*words, devices):
        asked.append(("kinetix", words[words.index("--batches") + 1], devices))
        return [{"devices": devices, "compile_s": 1.0, "env_steps_per_s": 50.0,
                 "engine_steps_per_s": 70.0}]  # fmt: skip

    monkeypatch.setattr(levels, "ask", answer)
    monkeypatch.setattr(levels, "measured_apart", apart)
    monkeypatch.setattr(levels, "NATIVE", ())
    monkeypatch.setattr(Peer, "installed", True)
    rows = list(levels.measure_levels(levels.LevelSettings(sizes=("s",), batch=64)))
    assert asked == [
        ("kinetix-env", "env", 64, "1"), ("kinetix", "64", 1),
        ("kinetix-env", "env", 64, "2"), ("kinetix", "64", 2),
        ("kinetix-env", "engine", 64, "1"), ("kinetix", "64", 1),
        ("kinetix-env", "engine", 64, "2"), ("kinetix", "64", 2),
        ("kinetix-env", "engine", 1, "1"), ("kinetix", "1", 1),
    ]  # fmt: skip
    assert rows[0]["steps_per_s"] == 10.0
    assert (rows[1]["engine"], rows[1]["steps_per_s"], rows[5]["steps_per_s"]) == (
        "kinetix", 50.0, 70.0,
    )  # fmt: skip


def test_number_of_devices_is_replaced_in_the_flags(monkeypatch):
    monkeypatch.setenv("XLA_FLAGS", "--xla_one --xla_force_host_platform_device_count=8")
    assert processes.host_devices(2) == {
        "XLA_FLAGS": "--xla_one --xla_force_host_platform_device_count=2"
    }


def test_measuring_apart_passes_on_rows_and_complaints():
    with pytest.raises(KinetixError, match=r"kinetix bench accuracy: .*no scene 'Q1'"):
        processes.measured_apart("accuracy", "--scenes", "Q1", devices=1)


@pytest.mark.parametrize(
    "name",
    [
        "box2d",
        "pymunk",
        "mujoco",
        *(pytest.param(name, marks=pytest.mark.slow) for name in ("mjx", "brax generalized")),
    ],
)
def test_real_peers_lag_by_eulers_error(name):
    peer = peer_named(name)
    if not peer.installed:
        pytest.skip(f"{name} is not installed; `make bench-peers` does")
    (row,) = measure_peer(peer, "I2")
    assert row["value"] == pytest.approx(9.81 / 120, rel=1e-2)
