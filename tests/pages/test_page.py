"""Pages: small, self-contained, and what they hold is what was played."""

import base64
import dataclasses
import json
import re

import numpy as np
import pytest

import kinetix
from editor.play.trace_files import write_trace
from kinetix.cli import main
from kinetix.errors import KinetixError
from kinetix.level.codec import load_level, save_level
from kinetix.pages.film import Film, packed, scene_of
from kinetix.pages.page import page_of
from tests.editor.core.helpers import a_level
from tests.editor.core.test_viewer import a_trace


def a_film(count=257, name="m/leapfrog", **changes):
    level = load_level(name)
    bodies = len(level.bodies)
    drift = np.linspace(0, 1, count)[:, None, None] * np.array([0.5, 0.25])
    start = np.array([body.position for body in level.bodies])
    values = {
        "level": level,
        "title": "general",
        "seconds": np.arange(count) / 30,
        "position": start + drift,
        "angle": np.linspace(-4, 4, count)[:, None] + np.zeros(bodies),
        "actions": np.tile([1.0, -1.0, 0, 0, 0.5, 0], (count, 1)),
        "value": np.linspace(-0.5, 1.2, count),
        "entropy": np.full(count, np.nan),
        "outcome": "won",
        "facts": (("physics", "balanced"),),
    }
    return Film(**(values | changes))


def read(page):
    return json.loads(re.search(r'id="data">(.*?)</script>', page, re.S)[1])


def numbers(text, kind):
    return np.frombuffer(base64.b64decode(text), kind)


def poses_of(stored):
    """Return positions [m] and angles [rad] of all bodies in the moments that have poses."""
    shown, moving = numbers(stored["shown"], "<u4"), stored["moving"]
    poses = np.repeat(np.array(stored["start"], float)[None], len(shown), axis=0)
    poses[:, moving, :2] = numbers(stored["places"], "<i2").reshape(len(shown), -1, 2)
    poses[:, moving, 2] = numbers(stored["angles"], "<i4").reshape(len(shown), -1)
    return poses[..., :2] / 1000, poses[..., 2] * 2 * np.pi / 65536


def test_what_was_played_is_on_the_page():
    film = a_film()
    stored = packed(film)
    position, angle = poses_of(stored)
    np.testing.assert_allclose(position, film.position, atol=6e-4)
    np.testing.assert_allclose(angle, film.angle, atol=2e-4)
    np.testing.assert_allclose(numbers(stored["seconds"], "<u4") / 1000, film.seconds, atol=6e-4)
    np.testing.assert_allclose(numbers(stored["value"], "<i2") / 1000, film.value, atol=1e-3)
    assert stored["entropy"] is None
    assert scene_of(film.level)["controls"]


def test_what_broke_down_stays_where_it_was_last(recwarn):
    film = a_film(10)
    position, angle = film.position.copy(), film.angle.copy()
    position[6:, 0], angle[8:, 1] = np.nan, np.inf
    stored = packed(dataclasses.replace(film, position=position, angle=angle))
    poses, _ = poses_of(stored)
    assert (poses[6:, 0] == poses[5, 0]).all() and (poses[8:, 1] == poses[7, 1]).all()
    assert (poses[6:, 2] != poses[5, 2]).any()
    assert not recwarn.list


def test_what_never_moves_has_one_pose():
    film = a_film(100)
    position, angle = film.position.copy(), film.angle.copy()
    position[:, 1:], angle[:, 1:] = position[0, 1:], angle[0, 1:]
    stored = packed(dataclasses.replace(film, position=position, angle=angle))
    assert stored["moving"] == [0]
    np.testing.assert_allclose(poses_of(stored)[0], position, atol=6e-4)


def test_of_many_moments_some_poses_are_left_out_and_no_controls(monkeypatch):
    monkeypatch.setattr("kinetix.pages.film.MOST_BYTES", 20_000)
    count = 601
    bodies = len(a_film(2).level.bodies)
    angle = np.arange(count)[:, None] * 0.5 + np.zeros(bodies)  # 30 rad/s
    actions = np.zeros((count, 6))
    actions[300:303, 4] = 1.0
    film = a_film(count, angle=angle, actions=actions, seconds=np.arange(count) / 60)
    stored = packed(film)
    shown = numbers(stored["shown"], "<u4")
    assert len(shown) < count == stored["count"]
    assert numbers(stored["actions"], "<i1").reshape(-1, 6)[:, 4].sum() == 300
    turned = np.diff(poses_of(stored)[1][:, 0]) / np.diff(film.seconds[shown])
    np.testing.assert_allclose(turned, 30, rtol=1e-3)
    assert dict(stored["facts"])["left out"].startswith(f"{count - len(shown)} of 601 moments")


@pytest.mark.parametrize(("count", "most"), [(257, 200_000), (20_000, 2_000_000)])
def test_two_players_fit_in_a_small_page(count, most):
    film = a_film(count, name="l/rover_ridge")
    page = page_of([film, film])
    assert len(page.encode()) < most
    assert "http" not in page.replace("http-equiv", "")
    content = read(page)
    assert [stored["outcome"] for stored in content["films"]] == ["won", "won"]
    first = content["films"][0]
    assert numbers(first["seconds"], "<u4")[-1] == round(1000 * film.seconds[-1])


def test_words_of_a_level_cannot_leave_the_page_s_data():
    level = load_level("s/wheelie").replace(name="</script><b>{{script}}")
    page = page_of([a_film(3, level=level, **_poses(level, 3))])
    assert "</script><b>" not in page
    assert page.count("Plays what #data holds") == 1
    assert page.count("{{script}}") == 3  # the name, as text: title, heading, data
    assert read(page)["scene"]["name"] == level.name


def _poses(level, count):
    bodies = len(level.bodies)
    return {"position": np.zeros((count, bodies, 2)), "angle": np.zeros((count, bodies))}


def test_an_episode_of_the_editor_is_shown(tmp_path):
    trace = a_trace()
    write_trace(trace, a_level(), tmp_path / "episode.npz")
    (film,) = read(kinetix.show(tmp_path / "episode.npz").html)["films"]
    assert (film["title"], film["count"]) == ("Tester", len(trace.snapshots))
    position, _ = poses_of(film)
    np.testing.assert_allclose(position[-1], trace.snapshots[-1].position, atol=6e-4)
    (tmp_path / "no.npz").write_bytes(b"nothing")
    for name in ("no.npz", "gone.npz"):
        with pytest.raises(KinetixError, match=name):
            kinetix.show(tmp_path / name)


@pytest.mark.parametrize("name", ["value", "unified", "frame_skip", "attempt", "step"])
@pytest.mark.parametrize("content", ["text", np.zeros((2, 1)), -1])
def test_an_episode_with_other_arrays_is_refused_in_a_sentence(tmp_path, name, content):
    file = tmp_path / "a.npz"
    write_trace(a_trace(), a_level(), file)
    with np.load(file) as stored:
        arrays = dict(stored)
    np.savez(file, **(arrays | {name: np.asarray(content)}))
    with pytest.raises(KinetixError, match="expected an episode of the editor"):
        kinetix.show(file)


def test_what_cannot_be_shown_is_said():
    with pytest.raises(KinetixError, match="one run, or two"):
        kinetix.show()
    with pytest.raises(KinetixError, match="got int"):
        kinetix.show(7)
    with pytest.raises(KinetixError, match="same level"):
        kinetix.show(load_level("s/wheelie"), load_level("m/leapfrog"))


def test_a_level_is_the_same_with_another_name_and_its_solution():
    level = load_level("s/first_flight")
    other = level.replace(name="Mine", tags=("tried",), solution=None)
    assert level.solution is not None
    films = read(kinetix.show(level, other).html)["films"]
    assert len(films) == 2


def test_a_level_is_shown_in_a_notebook(tmp_path):
    page = kinetix.show(load_level("s/wheelie"))
    framed = page._repr_html_()
    assert framed.startswith("<iframe srcdoc=")
    assert "<script" not in framed
    page.save(tmp_path / "a.html")
    assert (tmp_path / "a.html").read_text() == page.html


def test_a_level_is_shown_by_its_name_and_file(tmp_path):
    level = load_level("s/goalkeeper")
    save_level(level, tmp_path / "mine.json")
    for named in ("s/goalkeeper", tmp_path / "mine.json"):
        assert kinetix.show(named).html == kinetix.show(level).html
    with pytest.raises(KinetixError, match=r"name of a level, .* did you mean 's/goalkeeper'"):
        kinetix.show("s/goalkeper")
    (tmp_path / "a.txt").write_text("text")
    with pytest.raises(KinetixError, match=r"expected .* an episode \(\.npz\): .*a\.txt"):
        kinetix.show(tmp_path / "a.txt")


@pytest.mark.slow
def test_the_command_writes_an_episode_and_a_comparison(tmp_path, capsys):
    out = tmp_path / "a.html"
    assert (
        main(["render", "s/first_flight", str(out), "--agent", "solution", "--rival", "noop"]) == 0
    )
    content = read(out.read_text())
    assert [film["title"] for film in content["films"]] == ["solution", "noop"]
    assert content["films"][0]["outcome"] == "won"
    assert main(["render", "s/first_flight", str(tmp_path / "a.png"), "--rival", "noop"]) == 1


def test_an_array_is_no_film_and_that_is_said():
    with pytest.raises(KinetixError, match="got ndarray"):
        kinetix.show(np.zeros(3))
