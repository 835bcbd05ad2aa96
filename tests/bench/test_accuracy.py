import dataclasses
import json
import math
import runpy
from pathlib import Path

import numpy as np
import pytest

from kinetix import cli
from kinetix.bench import accuracy, references
from kinetix.bench.accuracy import AccuracySettings, measure_accuracy, metrics_of, row_of
from kinetix.bench.judges import JUDGES, Metric
from kinetix.bench.judges.base import each, normalised_error
from kinetix.bench.judges.built import DOMINO_SPEED
from kinetix.bench.motion import Motion
from kinetix.bench.probes import PROBES
from kinetix.bench.report import class_errors, markdown_table, scene_text, verdict_counts
from kinetix.engine.presets import solver_named
from kinetix.level.sizes import SIZES
from kinetix.scenes import SCENES
from kinetix.scenes.model import Trial
from kinetix.scenes.stage import Stage

FIELDS = ["scene", "class", "physics", "metric", "unit", "value", "good", "fail", "verdict"]


def resting(trial):
    """A motion in which nothing ever happens."""
    bodies, rows = trial.level.bodies, trial.steps + 1
    return Motion(
        trial=trial,
        position=np.tile(np.array([body.position for body in bodies], np.float64), (rows, 1, 1)),
        rotation=np.tile(np.array([body.angle for body in bodies], np.float64), (rows, 1)),
        velocity=np.zeros((rows, len(bodies), 2)),
        angular_velocity=np.zeros((rows, len(bodies))),
    )


def thrown(kick):
    """I2 by symplectic Euler (`kick` 1), exactly (½) or by explicit Euler (0)."""
    (trial,) = SCENES["I2"].make_trials()
    motion = resting(trial)
    t, dt = motion.time, trial.dt
    motion.position[:, 0, 0] = 3 * t
    motion.position[:, 0, 1] = 6 * t - 9.81 * t * (t + (2 * kick - 1) * dt) / 2
    return motion


def worst(id, motions):
    metrics = JUDGES[id](motions)
    return max(metrics, key=lambda metric: metric.error)


def test_every_scene_is_judged():
    assert set(SCENES) == set(JUDGES) | set(PROBES)
    assert not set(JUDGES) & set(PROBES)


@pytest.mark.parametrize(
    ("value", "good", "fail", "error", "verdict"),
    [
        (0.5, 1.0, 2.0, 0.25, "good"),
        (1.5, 1.0, 2.0, 0.75, "ok"),
        (2.0, 1.0, 2.0, 1.0, "fail"),
        (None, 1.0, 2.0, 10.0, "fail"),
        (1.95, 1.9, 1.1, 0.0, "good"),
        (1.5, 1.9, 1.1, 0.5, "ok"),
        (1.0, 1.9, 1.1, 1.125, "fail"),
        (0.0, 0.0, 0.0, 0.0, "good"),
        (0.25, 0.0, 0.0, 1.25, "fail"),
    ],
)
def test_scores(value, good, fail, error, verdict):
    metric = Metric(name="m", unit="1", value=value, good=good, fail=fail)
    assert metric.verdict == verdict
    assert metric.error == pytest.approx(error)
    assert normalised_error(value, good, fail) == pytest.approx(error)


def test_worst_phase_counts_and_the_median_is_reported():
    stage = Stage("phases")
    stage.disc(0.1, 0.0, 0.0)
    motions = [
        dataclasses.replace(resting(Trial(level=stage.level(), duration=0.1, phase=k)), overflow=k)
        for k in range(3)
    ]
    judge = each(
        lambda motion: [Metric(name="m", unit="1", value=motion.overflow, good=0.5, fail=4.0)]
    )
    first, second = judge(motions)
    assert (first.value, first.verdict) == (2, "ok")
    assert (second.label, second.value, second.verdict) == ("m, median of phases", 1, None)


@pytest.mark.parametrize("spoil", [math.nan, 2e3])
def test_broken_run_fails_without_a_value(spoil):
    motion = thrown(0.5)
    motion.position[30:, 0, 0] = spoil
    assert motion.wild_after == pytest.approx(0.5)
    metric = worst("I2", [motion])
    assert (metric.value, metric.verdict, metric.error) == (None, "fail", 10)


def test_parabola_is_good_and_euler_fails_by_what_it_lags_behind():
    assert worst("I2", [thrown(0.5)]).value < 1e-12
    metric = worst("I2", [thrown(1.0)])
    assert metric.value == pytest.approx(9.81 / 2 / 60)
    assert metric.verdict == "fail"


@pytest.mark.parametrize(
    "id",
    [
        *("F4", "D6", "S1", "S2", "S3", "S4", "S5", "S6", "S7", "S11", "R1"),
        *("U1", "U2", "U3", "U4", "U5", "U6", "U12", "U21", "U22", "U23"),
    ],
)
def test_what_must_not_move_is_good_when_it_does_not(id):
    found = JUDGES[id]([resting(trial) for trial in SCENES[id].make_trials()])
    assert {metric.verdict for metric in found} - {None} == {"good"}


@pytest.mark.parametrize(
    "id",
    [
        *("I1", "F1", "F3", "D2", "D3", "D10", "B7", "D1"),
        *("U7", "U8", "U9", "U10", "U11", "U13", "U14", "U24", "U25", "U26", "U27", "U28"),
    ],
)
def test_what_must_move_fails_when_it_does_not(id):
    found = JUDGES[id]([resting(trial) for trial in SCENES[id].make_trials()])
    assert "fail" in {metric.verdict for metric in found}


@pytest.mark.parametrize("id", ["U16", "U17", "U18", "U19", "U20"])
def test_what_leaves_fails_however_few_they_are(id):
    motions = [resting(trial) for trial in SCENES[id].make_trials()]
    assert {metric.verdict for metric in JUDGES[id](motions)} == {"good"}
    motions[-1].position[-1, -1] = (3.0, 3.0)
    found = JUDGES[id](motions)
    assert [metric.verdict for metric in found].count("fail") == 1
    (value,) = (metric.value for metric in found if metric.verdict == "fail")
    assert 0 < value < 0.2


def test_rocking_loses_what_housner_says():
    trial = SCENES["U25"].make_trials()[1]
    motion = resting(trial)
    # Alternating angles of a block whose energy falls at each impact by the formula's share.
    width, height = trial.values["width"], trial.values["height"]
    share = (1 - 1.5 * math.sin(math.atan(width / height)) ** 2) ** 2
    phase = np.arange(len(motion.time)) // 30
    motion.rotation[:, 1] = 0.1 * (-1.0) ** phase
    motion.position[:, 1, 1] = height / 2 + 0.01 * share**phase
    found = worst("U25", [motion])
    assert found.value == pytest.approx(0, abs=1e-5)
    motion.position[:, 1, 1] = height / 2 + 0.01 * (0.9 * share) ** phase
    assert worst("U25", [motion]).verdict == "fail"


def test_domino_speed_is_that_of_the_example():
    path = Path(__file__).resolve().parents[2] / "examples" / "domino.py"
    names = runpy.run_path(str(path))
    assert names["wave_speed"](0.4, 0.05, 0.15) == pytest.approx(DOMINO_SPEED, rel=1e-3)


def test_scenes_are_run_in_the_step_of_their_own_and_of_their_size(monkeypatch):
    asked = []

    def run(trials, solver, *, binary64, spec=None):
        asked.append((len(trials), spec and spec.capacity))
        return [resting(trial) for trial in trials]

    monkeypatch.setattr(accuracy, "run_trials", run)
    found = metrics_of(SCENES["U1"], solver_named("fast"), "fast")
    # Walls of 2×2 and of 4×2 need different capacities, but both fit size l.
    assert [count for count, _ in asked] == [10, 10, 10, 10]
    assert [capacity for _, capacity in asked] == [None, SIZES["l"], None, SIZES["l"]]
    labels = {metric.label for metric in found}
    assert "moved (4×2 of 0.3 m free)" in labels
    assert "moved (4×2 of 0.3 m free in its size's step)" in labels


def test_fallen_stack_has_no_value():
    motions = [resting(trial) for trial in SCENES["S1"].make_trials()]
    motions[0].rotation[-1, 3] = 0.3
    found = [metric for metric in JUDGES["S1"](motions) if metric.variant == "N 5"]
    assert [metric.value for metric in found] == [None] * 3


def test_bouncing_disc_is_measured_by_its_apexes():
    trial = SCENES["B2"].make_trials()[8]
    e, height = trial.values["restitution"], trial.values["height"]
    motion = resting(trial)
    # Free flights joined by ideal bounces.
    bounce, speed = math.sqrt(2 * height / 9.81), 9.81 * math.sqrt(2 * height / 9.81)
    ends = [bounce]
    for k in range(1, 12):
        ends.append(ends[-1] + 2 * e**k * speed / 9.81)
    for row, t in enumerate(motion.time):
        k = sum(end <= t for end in ends)
        start = ends[k - 1] if k else 0.0
        v0 = e**k * speed if k else 0.0
        motion.velocity[row, 1, 1] = v0 - 9.81 * (t - start) if t < ends[-1] else 0
        y = v0 * (t - start) - 9.81 * (t - start) ** 2 / 2 + (0 if k else height)
        motion.position[row, 1, 1] = 0.2 + (y if t < ends[-1] else 0)
    metric, *_ = JUDGES["B2"]([motion])
    assert metric.value < 1e-9
    motion.position[60:, 1, 1] += 0.2
    assert JUDGES["B2"]([motion])[0].verdict == "fail"


@pytest.mark.parametrize(
    ("second", "depth"),
    [
        (lambda stage: stage.box(0.2, 0.2, 0.15, 0.02), 0.05),
        (lambda stage: stage.box(0.2, 0.2, 0.35, 0.0), 0.0),
        (lambda stage: stage.disc(0.1, 0.19, 0.0), 0.01),
        (lambda stage: stage.disc(0.1, 0.16, 0.18), 0.0),
        (
            lambda stage: stage.box(0.2, 0.2, 0.1 + 0.1 * math.sqrt(2) - 0.03, 0.0, math.pi / 4),
            0.03,
        ),
    ],
)
def test_overlaps(second, depth):
    stage = Stage("overlap")
    stage.box(0.2, 0.2, 0.0, 0.0)
    second(stage)
    motion = resting(Trial(level=stage.level(), duration=0.1))
    assert motion.penetration()[-1] == pytest.approx(depth, abs=1e-6)


def test_energy_counts_every_body():
    (trial,) = SCENES["I3"].make_trials()
    motion = resting(trial)
    motion.velocity[:, 0, 0] = 1.0
    motion.angular_velocity[:, 0] = 10.0
    assert motion.energy()[0] == pytest.approx(0.12 / 2 + 0.004 * 100 / 2)


def test_stored_solutions_are_those_of_the_equations(monkeypatch):
    monkeypatch.setattr(references, "FINE_STEP", 1 / 600)
    kept = references.stored()
    for degrees in (45, 90):
        angle = references.pendulum_angle(math.radians(degrees), 1 / 60, 300)
        assert angle[-1] == pytest.approx(kept["pendulum"][str(degrees)], abs=1e-6)
    np.testing.assert_allclose(
        references.double_pendulum_tip(1 / 60, 90), kept["double_pendulum"], atol=1e-5
    )
    np.testing.assert_allclose(
        references.offset_thrust_tip(1 / 60, 120), kept["offset_thrust"], atol=1e-6
    )


def test_solutions_agree_with_scipy():
    integrate = pytest.importorskip("scipy.integrate")
    stiffness = references.rod_stiffness(1.0, 0.1)
    assert stiffness == pytest.approx(14.678, abs=1e-3)
    found = integrate.solve_ivp(
        lambda _, y: (y[1], -stiffness * math.sin(y[0])),
        (0, 5),
        (math.pi / 2, 0),
        rtol=1e-11,
        atol=1e-12,
    )
    assert found.y[0, -1] == pytest.approx(references.stored()["pendulum"]["90"], abs=1e-8)


def test_double_pendulum_agrees_with_the_same_rods_as_a_constrained_system():
    """Cartesian coordinates and Lagrange multipliers instead of two angles."""
    integrate = pytest.importorskip("scipy.integrate")
    half, inertia = 0.25, (0.25 + 0.0025) / 12
    mass = np.diag([1, 1, inertia, 1, 1, inertia])
    pull = np.array([0, -9.81, 0, 0, -9.81, 0])

    def derivative(_, y):
        q, v = y[:6], y[6:]
        c1, s1, c2, s2 = math.cos(q[2]), math.sin(q[2]), math.cos(q[5]), math.sin(q[5])
        rows = np.array(
            [
                [1, 0, -half * c1, 0, 0, 0],
                [0, 1, -half * s1, 0, 0, 0],
                [-1, 0, -half * c1, 1, 0, -half * c2],
                [0, -1, -half * s1, 0, 1, -half * s2],
            ]
        )
        bend = half * np.array(
            [
                s1 * v[2] ** 2,
                -c1 * v[2] ** 2,
                s1 * v[2] ** 2 + s2 * v[5] ** 2,
                -c1 * v[2] ** 2 - c2 * v[5] ** 2,
            ]
        )
        whole = np.block([[mass, rows.T], [rows, np.zeros((4, 4))]])
        return np.concatenate([v, np.linalg.solve(whole, [*(mass @ pull), *-bend])[:6]])

    right = math.pi / 2
    start = [half, 0, right, 3 * half, 0, right, *[0.0] * 6]
    found = integrate.solve_ivp(derivative, (0, 1.5), start, rtol=1e-10, atol=1e-11).y[:, -1]
    tip = found[3] + half * math.sin(found[5]), found[4] - half * math.cos(found[5])
    np.testing.assert_allclose(tip, references.stored()["double_pendulum"][-1], atol=1e-6)


def test_disc_bounces_as_the_suite_says():
    np.testing.assert_allclose(
        references.bounce_off((1.0, -4.0), -20.0, 0.2, 0.5, 0.3), (2.0, 2.0, -10.0), atol=1e-9
    )
    assert math.degrees(references.stalled_arm_angle(0.05)) == pytest.approx(19.49, abs=0.01)
    assert references.small_swing_period(math.radians(5)) == pytest.approx(1.64077, abs=1e-5)


def test_row_says_the_worst_and_all():
    metrics = [
        Metric(name="told only", unit="m", value=99.0),
        Metric(name="ok", unit="m", value=1.5, good=1.0, fail=2.0, variant="a"),
        Metric(name="good", unit="m", value=0.0, good=1.0, fail=2.0),
    ]
    row = row_of(SCENES["D2"], "balanced", metrics)
    assert list(row) == [*FIELDS, "metrics"]
    assert [row[field] for field in FIELDS] == [
        "D2", "joints", "balanced", "ok (a)", "m", 1.5, 1.0, 2.0, "ok",
    ]  # fmt: skip
    assert [each["verdict"] for each in row["metrics"]] == [None, "ok", "good"]
    assert all(list(each) == FIELDS for each in row["metrics"])


def test_class_error_is_the_geometric_mean_of_core_scenes():
    def row(id, value):
        metric = Metric(name="m", unit="1", value=value, good=0.1, fail=1.0)
        return row_of(SCENES[id], "balanced", [metric])

    rows = [row("D2", 1e-9), row("D3", None), row("D1", 5.0), row("F1", 0.5)]
    assert class_errors(rows) == pytest.approx({"joints": math.sqrt(1e-6 * 10), "friction": 0.5})
    assert verdict_counts(rows) == {"good": 1, "ok": 1, "fail": 2}
    table = markdown_table({"balanced": rows})
    assert "| D3 double pendulum ● | ✗ failed m |" in table
    assert scene_text(rows[3]).startswith("F1  slide")


def test_peer_physics_lags_as_euler_does(capsys):
    assert cli.main(["bench", "accuracy", "--scenes", "I2", "--physics", "jax2d", "--json"]) == 0
    (line,) = capsys.readouterr().out.splitlines()
    row = json.loads(line)
    assert row["verdict"] == "fail"
    assert row["value"] == pytest.approx(9.81 / 2 / 60, rel=1e-3)


@pytest.mark.slow
def test_default_physics_is_good_where_the_peers_fails():
    settings = AccuracySettings(scenes="I2,D4,B1", physics="balanced")
    assert [row["verdict"] for row in measure_accuracy(settings)] == ["good"] * 3


def test_wrong_names_are_said_before_anything_runs(capsys):
    assert cli.main(["bench", "accuracy", "--scenes", "Q1"]) == 1
    assert "no scene 'Q1'" in capsys.readouterr().err
    assert cli.main(["bench", "accuracy", "--physics", "bullet"]) == 1
    assert "unknown physics 'bullet'" in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.parametrize("name", ["B4", "B5", "B7", "D2", "D3", "D5", "D6"])
def test_default_method_is_good_where_swings_and_blows_are_hard(name):
    metrics = metrics_of(SCENES[name], solver_named("balanced"), "balanced")
    assert {m.label: m.value for m in metrics if m.verdict not in (None, "good")} == {}
