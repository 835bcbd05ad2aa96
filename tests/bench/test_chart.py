import json
import math
from pathlib import Path

import pytest
from PIL import Image

from kinetix import cli
from kinetix.bench import scaling
from kinetix.bench.chart import build, points
from kinetix.bench.chart.draw import draw_chart
from kinetix.bench.chart.front import dominates, pareto_front, scalars
from kinetix.bench.chart.points import Point, points_of, read_points, write_rows, write_speeds
from kinetix.bench.chart.scaling import write_scaling
from kinetix.bench.scene_speed import SPEED_SCENES, Rate, measure_scenes, speed_trial
from kinetix.engine.presets import PRESETS, SOLVERS
from kinetix.scenes import SCENE_CLASSES, SCENES


def point(name, speed, error, family="kinetix", **fields):
    given = {"group": "joints", "batch": 1, "failed": 0, "scenes": 6} | fields
    return Point(family=family, name=name, speed=speed, error=error, **given)


def row(id, value, **fields):
    """A row of the suite in which 1 fails."""
    head = {"scene": id, "class": SCENES[id].group, "physics": "p"}
    verdict = "good" if value is not None and value < 1 else "fail"
    metric = {"metric": "m", "unit": "1", "value": value, "good": 1.0, "fail": 1.0}
    return head | metric | {"verdict": verdict, "metrics": [head | metric | {"verdict": verdict}]}


def speed(group, batch, rate, **fields):
    return {"class": group, "batch": batch, "steps_per_s": rate, "devices": 1, **fields}


@pytest.fixture
def results(tmp_path):
    """Two engines: ours is right and slow, the other fast and wrong."""
    folder = tmp_path / "bench"
    ours = [row("D2", 0.01), row("F1", 0.1)]
    write_rows(folder / "accuracy" / "balanced.jsonl", ours)
    write_rows(folder / "peers" / "jax2d.jsonl", [row("D2", None), row("F1", 0.5)])
    speeds = [speed("joints", 1, 600.0), speed("friction", 1, 6000.0)]
    write_speeds(folder, "balanced", "kinetix", speeds)
    write_speeds(folder, "jax2d", "jax2d", [speed("joints", 1, 1200.0)])
    write_speeds(folder, "box2d dt/2", "box2d", [speed("joints", 1, 1200.0)])
    return folder


def test_points_join_errors_and_speeds(results):
    found = {(p.name, p.group): p for p in read_points(results)}
    # Box2D's errors have not been measured, jax2d's speed on slopes neither.
    assert set(found) == {
        ("balanced", "joints"),
        ("balanced", "friction"),
        ("balanced", "robustness"),
        ("jax2d", "joints"),
        ("jax2d", "robustness"),
    }
    ours = found["balanced", "joints"]
    assert (ours.speed, ours.error) == pytest.approx((10.0, 0.01))
    assert (ours.failed, ours.scenes) == (0, 1)
    theirs = found["jax2d", "joints"]
    assert (theirs.speed, theirs.error) == pytest.approx((20.0, 10.0))
    assert (theirs.family, theirs.failed) == ("jax2d", 1)


def test_robustness_is_the_share_of_failures_at_the_mean_speed(results):
    found = {(p.name, p.group): p for p in read_points(results)}
    assert found["jax2d", "robustness"].error == 0.5
    assert found["balanced", "robustness"].error == 0
    assert found["balanced", "robustness"].speed == pytest.approx(math.sqrt(10.0 * 100.0))


def test_new_speeds_replace_those_of_their_batch_sizes(results):
    write_speeds(results, "balanced", "kinetix", [speed("joints", 1024, 60.0)])
    write_speeds(results, "balanced", "kinetix", [speed("joints", 1, 1200.0)])
    found = {p.batch: p.speed for p in read_points(results) if p.group == "joints" and p.error < 1}
    assert found == pytest.approx({1: 20.0, 1024: 1.0})


def test_a_scene_without_verdict_does_not_count():
    unsaid = row("D3", None) | {"verdict": None}
    (joints, robustness) = points_of(
        [speed("joints", 1, 60.0, family="f", name="n", measured="")], [row("D2", 0.1), unsaid]
    )
    assert (joints.scenes, robustness.scenes) == (1, 1)
    assert joints.error == pytest.approx(0.1)


def test_front_keeps_what_nothing_beats_in_both():
    fast, middle, exact = point("a", 100, 1.0), point("b", 10, 0.1), point("c", 1, 0.01)
    worse, twin = point("d", 9, 0.2), point("e", 10, 0.1)
    assert pareto_front([worse, exact, middle, fast]) == [fast, middle, exact]
    assert dominates(middle, worse)
    assert not dominates(middle, twin)
    assert {p.name for p in pareto_front([middle, twin])} == {"b", "e"}


def test_scalars_compare_with_the_peer_at_its_defaults():
    theirs = point("jax2d", 10, 0.5, family="jax2d")
    found = scalars([theirs, point("fast", 80, 0.4), point("balanced", 20, 0.05)])
    assert found == {"speed_ratio": 8.0, "error_ratio": 10.0, "ahead_of_us": []}


def test_scalars_without_a_comparable_point_are_none():
    theirs = point("jax2d", 10, 0.5, family="jax2d")
    # Our own preset of that name is not kinetix-env.
    slow_and_wrong = [point("jax2d", 5, 0.9), theirs]
    assert scalars(slow_and_wrong) == {
        "speed_ratio": None,
        "error_ratio": None,
        "ahead_of_us": ["jax2d"],
    }
    assert scalars([point("balanced", 5, 0.1)])["speed_ratio"] is None


def test_picture_shows_failures_too(tmp_path):
    good = [point("balanced", 10, 0.01), point("jax2d", 5, 0.2, family="jax2d")]
    failed = point("box2d", 20, 10.0, family="box2d", failed=2)
    draw_chart(good, tmp_path / "without.png")
    draw_chart([*good, failed], tmp_path / "with.png", note="machine")
    first, second = ((tmp_path / name).read_bytes() for name in ("without.png", "with.png"))
    assert first.startswith(b"\x89PNG") and second.startswith(b"\x89PNG")
    assert first != second


def test_a_class_that_nobody_was_timed_in_has_no_row(tmp_path):
    def height(*points):
        draw_chart(points, tmp_path / "chart.png")
        with Image.open(tmp_path / "chart.png") as picture:
            return picture.height

    one, other = point("balanced", 10, 0.01), point("balanced", 10, 0.01, group="impacts")
    assert height(one, other) > 1.5 * height(one)


def test_command_draws_from_what_is_stored(results, tmp_path, capsys, monkeypatch):
    out = tmp_path / "docs"
    words = ["bench", "chart", "--physics", "none", "--results", str(results), "--out", str(out)]
    assert cli.main([*words, "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data == json.loads((out / "chart.json").read_text())
    assert (out / "chart.png").stat().st_size > 10_000
    assert {facet["class"] for facet in data["facets"]} == set(SCENE_CLASSES)
    joints = next(facet for facet in data["facets"] if facet["class"] == "joints")
    assert joints["ahead_of_us"] == ["jax2d"]
    assert len(data["points"]) == 5
    monkeypatch.setattr(build, "draw_chart", lambda *_, **__: None)
    assert cli.main(words) == 0
    assert "joints          1 worlds: speed at equal error" in capsys.readouterr().out


def test_a_busy_machine_is_told_of():
    quiet, busy = (point("balanced", 1, 0.1, load=load) for load in (1.0, 8.0))
    assert "busy" not in build.chart_data([quiet])["note"]
    assert "busy (load 8)" in build.chart_data([quiet, busy])["note"]


def test_command_without_any_rows_says_so(tmp_path, capsys):
    words = ["bench", "chart", "--physics", "none", "--results", str(tmp_path)]
    assert cli.main(words) == 1
    assert "measure something first" in capsys.readouterr().err
    assert cli.main(["bench", "chart", "--physics", "bullet"]) == 1
    assert "unknown physics 'bullet'" in capsys.readouterr().err


def test_missing_errors_are_measured_before_the_speed(results, tmp_path, monkeypatch):
    asked = []

    def measured(*words, devices, cached):
        asked.append((words[0], words[words.index("--physics") + 1], devices))
        return [row("D2", 0.1)] if words[0] == "accuracy" else [speed("joints", 1, 60.0)]

    monkeypatch.setattr(build, "measured_apart", measured)
    monkeypatch.setattr(build, "draw_chart", lambda *_, **__: None)
    core = [row(id, 0.1) for id, scene in SCENES.items() if scene.counted]
    write_rows(results / "accuracy" / "balanced.jsonl", core)
    settings = build.ChartSettings(
        out=tmp_path, results=results, physics=("fast", "balanced"), batches=(1,), cores=3
    )
    said = []
    build.build_chart(settings, said.append)
    assert asked == [("accuracy", "fast", 1), ("speed", "fast", 3), ("speed", "balanced", 3)]
    assert said[0].startswith("fast: errors in I2,I3,")
    assert "fast" in {p.name for p in points.read_points(results)}


def test_only_missing_scenes_are_measured_and_take_their_place(tmp_path):
    file = tmp_path / "rows.jsonl"
    assert points.missing_scenes(file, "B1,D5") == "B1,D5"
    points.append_rows(file, [row("D5", 0.1)])
    assert points.missing_scenes(file, "B1,D5") == "B1"
    points.append_rows(file, [row("B1", 0.1)])
    assert points.missing_scenes(file, "B1,D5") == ""
    assert [each["scene"] for each in points.read_rows(file)] == ["B1", "D5"]


def test_chart_shows_every_method_once():
    shown = build.every_physics()
    assert "reference" not in shown
    assert {PRESETS.get(name) or SOLVERS[name] for name in shown} == {
        solver for name, solver in {**PRESETS, **SOLVERS}.items() if name != "reference"
    }
    assert len(set(shown)) == len(shown)


def test_every_class_but_robustness_has_a_scene_to_be_timed_in():
    assert {*SPEED_SCENES, "robustness"} == set(SCENE_CLASSES)
    assert all(SCENES[id].group == group for group, (id, _) in SPEED_SCENES.items())
    assert speed_trial("contacts").name == "N 10"
    rows = list(
        measure_scenes(
            [1, 4],
            lambda trial, batch: (
                None if batch > 1 else Rate(steps_per_s=1.0, compile_s=None, devices=1)
            ),
        )
    )
    assert [row["class"] for row in rows] == list(SPEED_SCENES)
    assert rows[0] == {
        "class": "integrator", "scene": "I2", "batch": 1,
        "steps_per_s": 1.0, "compile_s": None, "devices": 1,
    }  # fmt: skip


def test_scaling_measures_bodies_then_worlds(monkeypatch):
    counted = []

    def timed(trial, solver, batch):
        counted.append(len(trial.level.bodies) - 1)
        return Rate(steps_per_s=100.04, compile_s=1.234, devices=1)

    def apart(*words, devices):
        return [{"devices": devices, "engine_steps_per_s": 5.0, "compile_s": 2.0}]

    monkeypatch.setattr(scaling, "scene_speed", timed)
    monkeypatch.setattr(scaling, "measured_apart", apart)
    settings = scaling.ScalingSettings(bodies=(8, 64), worlds=(1, 16), devices=(1, 2))
    rows = list(scaling.measure_scaling(settings))
    assert counted == [8, 64]
    assert [(r.get("bodies"), r["worlds"], r["devices"]) for r in rows] == [
        (8, 1, 1), (64, 1, 1), (None, 1, 1), (None, 16, 1), (None, 16, 2),
    ]  # fmt: skip
    assert (rows[0]["steps_per_s"], rows[0]["compile_s"]) == (100.0, 1.23)


def test_the_scaling_chart_keeps_its_figures_beside_it(tmp_path):
    pytest.importorskip("matplotlib")
    rows = [
        {
            "bodies": n,
            "worlds": 1,
            "devices": 1,
            "physics": "fast",
            "steps_per_s": 9e4 / n,
            "compile_s": 2.0,
        }
        for n in (8, 64)
    ] + [
        {
            "size": "m",
            "worlds": n,
            "devices": d,
            "physics": "fast",
            "steps_per_s": 1e4 * n,
            "compile_s": 3.0,
        }
        for n in (1, 16)
        for d in (1, 2)
    ]
    write_scaling(rows, tmp_path / "docs" / "scaling.png")
    stored = json.loads((tmp_path / "docs" / "scaling.json").read_text())
    assert stored["rows"] == rows
    assert "fast" in stored["note"]
    with Image.open(tmp_path / "docs" / "scaling.png") as picture:
        assert picture.size == (1000, 600)


def test_towers_stand_on_the_floor_side_by_side():
    level = scaling.towers(9).level
    places = [body.position for body in level.bodies[1:]]
    assert len(places) == len(set(places)) == 9
    assert {round(y, 3) for _, y in places} == {0.1, 0.3, 0.5, 0.7}


def test_the_documents_chart_has_the_errors_that_are_stored():
    drawn = json.loads(Path("docs/chart.json").read_text())["points"]
    stored = {(p.name, p.group, p.batch): p.error for p in read_points(Path("bench"))}
    assert {(p["name"], p["group"], p["batch"]): p["error"] for p in drawn} == stored, "make chart"
