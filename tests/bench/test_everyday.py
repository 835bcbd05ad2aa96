import dataclasses
import json
import math
from types import SimpleNamespace

import numpy as np
import pytest

from kinetix import cli
from kinetix.bench.everyday import judge as judging
from kinetix.bench.everyday import measure
from kinetix.bench.everyday.judge import LIMITS, Recorded, judge
from kinetix.bench.motion import Motion
from kinetix.bench.runner import run_trials
from kinetix.engine.presets import PRESETS
from kinetix.errors import KinetixError
from kinetix.level.builder import LevelBuilder
from kinetix.level.model import Motor
from kinetix.scenes.everyday.catalogue import CLASSES, draw, draw_all
from kinetix.scenes.everyday.model import EverydayScene
from kinetix.scenes.model import Trial

STEPS = 60


def motion_of(trial, move=lambda k, position: position, **fields):
    """A motion in which `move` says where bodies are, and velocities follow."""
    level = trial.level
    start = np.array([body.position for body in level.bodies], float)
    position = np.stack([move(k, start.copy()) for k in range(STEPS + 1)])
    velocity = np.gradient(position, trial.dt, axis=0)
    still = np.zeros(position.shape[:2])
    values = {"rotation": still, "angular_velocity": still, "velocity": velocity} | fields
    return Motion(trial=trial, position=position, **values)


def boxes(*, motor=None, gravity=(0.0, 0.0)):
    """A box and a disc far apart, hinged to the box if there is a motor."""
    b = LevelBuilder(gravity=gravity, arena=False)
    box, disc = b.rectangle(0, 0, 1, 1, fixed=motor is not None), b.circle(2, 0, 0.5)
    if motor:
        b.hinge(box, disc, (2, 0), motor=motor)
    return Trial(level=b.build(), duration=1.0, motor=1.0)


def numbers(motion, **fields):
    more = {key: fields.pop(key) for key in ("twin", "fine") if key in fields}
    scene = EverydayScene(trial=motion.trial, **fields)
    return judge(Recorded(scene=scene, motion=motion, **more))


def moved(index, way):
    def move(k, position):
        position[index] += np.array(way) * k / STEPS
        return position

    return move


def test_a_body_that_should_rest_is_seen_to_move():
    motion = motion_of(boxes(), moved(1, (0.0, 0.003)))
    assert numbers(motion, rests=(2,))["moved"] == pytest.approx(0.003)
    assert numbers(motion, rests=(1,))["moved"] == 0
    assert numbers(motion, rests=(2,), rests_from=0.5)["moved"] == pytest.approx(0.0015)


def test_overlap_counts_from_that_at_the_start_and_with_the_arena():
    motion = motion_of(boxes(), moved(1, (-1.1, 0.0)))
    assert numbers(motion)["overlap"] == pytest.approx(0.1)
    b = LevelBuilder()
    b.circle(2, 0.5, 0.1)
    fallen = motion_of(Trial(level=b.build(), duration=1.0), moved(0, (0.0, -0.15)))
    assert numbers(fallen)["overlap"] == pytest.approx(0.15, abs=1e-5)


def test_a_joint_that_opens_is_seen():
    motion = motion_of(boxes(motor=Motor()), moved(1, (0.0, 0.02)))
    assert numbers(motion)["joints"] == pytest.approx(0.02)
    assert "joints" not in numbers(motion_of(boxes()))


def test_what_leaves_is_counted_even_when_it_comes_back():
    away = moved(1, (1.0, 0.0))
    motion = motion_of(boxes(), lambda k, position: away(min(k, STEPS - k), position))
    assert numbers(motion, inside=(1, 2), box=(-1, -1, 2.4, 1))["escaped"] == 1
    assert numbers(motion, inside=(1, 2), box=(-1, -1, 2.6, 1))["escaped"] == 0


def test_seams_are_the_difference_from_the_slab_beyond_a_hundredth_of_the_way():
    trial = boxes()
    slab = motion_of(trial, moved(1, (3.0, 0.0)))
    slower = motion_of(trial, moved(1, (2.98, 0.0)))
    bumped = motion_of(trial, moved(1, (3.0, 0.05)))
    assert numbers(slower, watched=(2,), twin=slab)["seams"] == 0
    assert numbers(bumped, watched=(2,), twin=slab)["seams"] == pytest.approx(0.02, abs=1e-3)


def test_the_outcome_counts_where_fine_runs_agree():
    trial = boxes()
    motion, fine = motion_of(trial, moved(1, (0.3, 0.0))), motion_of(trial, moved(1, (0.2, 0.0)))
    near = motion_of(trial, moved(1, (0.205, 0.0)))
    assert numbers(motion, fine=(near, fine))["outcome"] == pytest.approx(0.1)
    assert "outcome" not in numbers(motion, fine=(motion, fine))


def test_energy_out_of_nothing_is_seen_and_a_fall_is_none():
    falling = boxes(gravity=(0.0, -9.81))

    def fall(k, position):
        return position - [0.0, 9.81 / 2 * (k * falling.dt) ** 2]

    assert numbers(motion_of(falling, fall))["energy"] < 0.02

    def jump(k, position):
        return fall(k, position) + ([0.0, 1.0] if k > 30 else [0.0, 0.0])

    assert numbers(motion_of(falling, jump))["energy"] > 1


def test_a_motor_s_work_is_no_gain():
    trial = boxes(motor=Motor(speed=1.0, power=1.0))
    time = np.arange(STEPS + 1) * trial.dt
    # The law without load: ω' = −900 tanh(.1 (ω − 6)).
    spin, spins = 0.0, []
    for _ in time:
        spins.append(spin)
        for _ in range(100):
            spin -= 900 * math.tanh(0.1 * (spin - 6)) * trial.dt / 100
    turning = np.stack([np.zeros_like(time), np.array(spins)], axis=1)
    driven = motion_of(trial, angular_velocity=turning)
    assert driven.kinetic_energy()[-1] > 0.5
    assert numbers(driven)["energy"] == 0
    # Four times as fast as the motor turns is more than it can have done.
    wild = motion_of(trial, angular_velocity=4 * turning)
    assert numbers(wild)["energy"] > 0.02


def test_a_broken_run_is_bad_in_everything():
    motion = motion_of(boxes())
    velocity = motion.velocity.copy()
    velocity[-1] = np.nan
    found = numbers(dataclasses.replace(motion, velocity=velocity), rests=(2,))
    assert set(found.values()) == {None}
    assert judging.bad(found) == list(found)


def test_dropped_contacts_are_bad_however_few():
    motion = dataclasses.replace(motion_of(boxes()), overflow=0.01)
    assert judging.bad(numbers(motion)) == ["dropped"]


def test_a_row_tells_the_worst_and_where_it_is():
    still, moving = motion_of(boxes()), motion_of(boxes(), moved(1, (0.0, 0.01)))
    recorded = [
        Recorded(scene=EverydayScene(trial=each.trial, rests=(2,), room="m"), motion=each)
        for each in (still, moving)
    ]
    row = measure.row_of("walls", "fast", recorded, [judge(each) for each in recorded])
    assert (row["class"], row["physics"], row["scenes"], row["bad"]) == ("walls", "fast", 2, 1)
    assert row["worst"] == {
        "metric": "moved",
        "value": pytest.approx(0.01),
        "unit": "m",
        "scene": 1,
        "size": "m",
    }
    assert row["metrics"]["moved"]["bad"] == 1
    assert list(row["metrics"]) == [name for name in LIMITS if name in row["metrics"]]
    assert "moved 1/2" in measure.text_of(row)
    json.dumps(row)


WRONG = {
    "count": ({"count": 0}, "--count 0: expected at least 1"),
    "peer": ({"peer": "havok"}, "--peer havok: expected one of box2d, pymunk, jax2d"),
    "physics": ({"physics": "slow"}, "unknown physics 'slow'"),
    "class": ({"classes": ("wells",)}, "--classes wells: expected some of walls,"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_cannot_be_is_said_in_a_sentence(name):
    fields, text = WRONG[name]
    with pytest.raises(KinetixError, match=text):
        next(measure.measure_everyday(measure.EverydaySettings(**fields)))


@pytest.mark.slow
@pytest.mark.parametrize("name", CLASSES)
def test_every_class_runs_in_our_engine(name):
    # Scenes for one step, so that all classes share a compilation.
    numbers = [k for k in range(8) if draw(name, k, 0).room == "custom"]
    scenes = [dataclasses.replace(draw(name, k, 0), compared=False) for k in numbers]
    assert scenes
    for recorded in measure.record(scenes, "balanced"):
        found = judge(recorded)
        assert {"energy", "overlap", "dropped"} <= found.keys()
        assert None not in found.values()
        assert len(recorded.motion.position) == recorded.scene.trial.steps + 1


@pytest.mark.slow
def test_the_command_prints_a_line_per_class(capsys, tmp_path):
    words = ["bench", "everyday", "--count", "2", "--classes", "doors", "--peer", "jax2d", "--json"]
    assert cli.main([*words, "--save", str(tmp_path / "bad")]) == 0
    (line,) = capsys.readouterr().out.splitlines()
    row = json.loads(line)
    assert row.keys() >= {"class", "scenes", "bad", "worst", "metrics"}
    saved = list((tmp_path / "bad").glob("doors-*.json")) if row["bad"] else []
    assert len(saved) == row["bad"]


def test_what_a_level_file_cannot_hold_is_told_and_keeps_no_other_away(tmp_path, monkeypatch):
    scenes = [draw("valleys", number, 0) for number in (135, 136)]
    recorded = [SimpleNamespace(scene=scene) for scene in scenes]
    monkeypatch.setattr(measure, "draw_all", lambda *_: {"valleys": scenes})
    monkeypatch.setattr(measure, "record", lambda *_: recorded)
    monkeypatch.setattr(measure, "judge", lambda _: {"overlap": 1.0})
    (row,) = measure.measure_everyday(measure.EverydaySettings(save=tmp_path))
    assert [file.name for file in tmp_path.iterdir()] == ["valleys-1.json"]
    assert "angular_velocity" in row["unsaved"][0]
    assert row["unsaved"][0] in measure.text_of(row)


def test_boxes_that_jam_in_a_ring_at_speed_gain_no_energy():
    scene = draw_all(500, 0, tuple(CLASSES))["rings"][19]
    trial = dataclasses.replace(scene.trial, duration=0.5)
    (motion,) = run_trials([trial], PRESETS["balanced"])
    energy = motion.energy()
    assert energy.max() <= 1.001 * energy[0]
