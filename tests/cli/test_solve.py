"""`kinetix solve`: which levels are tried, what is recorded; the search stands in for itself."""

import os
import sys
import types
from pathlib import Path

import pytest

from kinetix.cli import main
from kinetix.errors import KinetixError
from kinetix.level.codec import load_level, save_level
from kinetix.level.model import Solution
from kinetix.level.validate import validate

CART = Path(__file__).parents[1] / "level" / "fixtures" / "v1" / "cart_and_bell.json"
SOLUTION = Solution(physics="balanced", frame_skip=2, actions=((3, (1, 0, 0, 0, 0, 0)),))


@pytest.fixture
def search(monkeypatch):
    """Replaces the search: every level whose time limit is even is won."""
    seen = types.SimpleNamespace(environments=[], levels=[])
    module = types.ModuleType("kinetix.environment.search.search")

    def solving_env(levels, *, physics):
        seen.environments.append((len(levels), physics))
        return object()

    def solve_level(level, **options):
        seen.levels.append(level.max_timesteps)
        told = {"plans": 256, "won": 0, "distance": 1.0, "compiling": 9.3}
        options["report"](types.SimpleNamespace(**told, seconds=0.0, compiled=False))
        for _ in range(5):
            options["report"](types.SimpleNamespace(**told, seconds=2.4, compiled=True))
        return None if level.max_timesteps % 2 else SOLUTION

    module.solving_env, module.solve_level = solving_env, solve_level
    monkeypatch.setitem(sys.modules, "kinetix.environment.search.search", module)
    replay = types.ModuleType("kinetix.environment.replay")
    replay.replay_solution = lambda level: "won" if level.solution == SOLUTION else "lost"
    monkeypatch.setitem(sys.modules, "kinetix.environment.replay", replay)
    return seen


@pytest.fixture
def folder(tmp_path):
    cart = load_level(CART).replace(tags=("unsolved", "cart"), solution=None)
    for steps in (10, 11, 12):
        save_level(cart.replace(max_timesteps=steps), tmp_path / f"{steps}.json")
    save_level(cart.replace(size="l", max_timesteps=14), tmp_path / "14.json")
    return tmp_path


def test_a_solution_that_wins_stays_in_a_backup(search, folder, capsys, monkeypatch):
    replay = sys.modules["kinetix.environment.replay"]
    monkeypatch.setattr(replay, "replay_solution", lambda level: "won")
    path, earlier = folder / "10.json", SOLUTION.replace(physics="fast")
    save_level(load_level(path).replace(solution=earlier), path)
    assert main(["solve", str(path), "--write"]) == 0
    assert load_level(path).solution == SOLUTION
    assert "10.json.bak" in capsys.readouterr().out
    (folder / "10.json.bak").rename(folder / "before.json")
    assert load_level(folder / "before.json").solution == earlier


def test_every_level_is_tried_and_what_is_found_is_recorded(search, folder, capsys):
    assert main(["solve", str(folder), "--write"]) == 1
    assert search.levels == [10, 11, 12, 14]
    assert search.environments == [(3, "balanced"), (1, "balanced")]
    assert load_level(folder / "10.json").solution == SOLUTION
    assert load_level(folder / "10.json").tags == ("cart",)
    assert load_level(folder / "11.json").tags == ("unsolved", "cart")
    assert "no solution found" in capsys.readouterr().err


def test_solved_levels_can_be_left_out(search, folder):
    main(["solve", str(folder), "--write"])
    search.levels.clear()
    assert main(["solve", str(folder), "--unsolved"]) == 1
    assert search.levels == [11]


def test_a_solution_that_wins_no_more_is_replaced_or_dropped(search, folder):
    stale = SOLUTION.replace(actions=((9, (2, 0, 0, 0, 0, 0)),))
    for name in ("10", "11"):
        level = load_level(folder / f"{name}.json")
        save_level(level.replace(solution=stale, tags=("cart",)), folder / f"{name}.json")
    assert main(["solve", str(folder / "10.json"), "--unsolved", "--write"]) == 0
    assert load_level(folder / "10.json").solution == SOLUTION
    assert main(["solve", str(folder / "11.json"), "--unsolved"]) == 1
    assert load_level(folder / "11.json").solution == stale
    assert main(["solve", str(folder / "11.json"), "--unsolved", "--write"]) == 1
    assert load_level(folder / "11.json").solution is None
    assert load_level(folder / "11.json").tags == ("cart", "unsolved")


def test_a_solution_under_unknown_physics_does_not_win(search, folder, monkeypatch):
    def replay_solution(level):
        raise KinetixError("physics 'warped': expected one of balanced")

    monkeypatch.setattr(
        sys.modules["kinetix.environment.replay"], "replay_solution", replay_solution
    )
    path = folder / "10.json"
    save_level(load_level(path).replace(solution=SOLUTION.replace(physics="warped")), path)
    assert main(["solve", str(path), "--unsolved", "--write"]) == 0
    assert load_level(path).solution == SOLUTION


def test_nothing_is_written_unless_asked(search, folder):
    assert main(["solve", str(folder / "10.json"), str(folder / "12.json")]) == 0
    assert load_level(folder / "10.json").solution is None


def test_a_level_needs_a_name(search, capsys):
    assert main(["solve"]) == 1
    assert "expected levels" in capsys.readouterr().err


def test_what_is_over_at_the_start_is_refused(search, folder, capsys):
    level = load_level(folder / "10.json")
    green = next(body for body in level.bodies if body.role == "green")
    bodies = tuple(
        body.replace(position=green.position) if body.role == "blue" else body
        for body in level.bodies
    )
    save_level(level.replace(bodies=bodies), folder / "10.json")
    assert main(["solve", str(folder / "10.json")]) == 1
    assert "10.json: $" in capsys.readouterr().err
    assert search.levels == []


def test_of_a_folder_what_is_no_task_is_left_out_with_a_sentence(search, folder, capsys):
    level = load_level(folder / "10.json")
    green = next(body for body in level.bodies if body.role == "green")
    blue = next(body for body in level.bodies if body.role == "blue")
    over = tuple(
        body.replace(position=green.position) if body is blue else body for body in level.bodies
    )
    save_level(level.replace(bodies=over), folder / "10.json")
    assert main(["solve", str(folder)]) == 1
    assert search.levels == [11, 12, 14]
    told = capsys.readouterr().err
    assert f"left out: {folder / '10.json'}: " in told and "touches blue at the start" in told


@pytest.mark.parametrize(
    ("role", "change", "why"),
    [
        ("green", {"role": "none"}, "E101"),
        ("blue", {"role": "none"}, "E102"),
        ("blue", {"collision": "ghost"}, "W216"),
    ],
)
def test_what_nothing_can_win_is_said_at_once(search, folder, capsys, role, change, why):
    level = load_level(folder / "10.json")
    plain = [b.replace(**change) if b.role == role else b for b in level.bodies]
    save_level(level.replace(bodies=tuple(plain)), folder / "10.json")
    (said,) = [
        issue.message for issue in validate(load_level(folder / "10.json")) if issue.code == why
    ]
    assert main(["solve", str(folder / "10.json")]) == 1
    assert said in capsys.readouterr().err
    assert search.levels == []


def test_no_more_seconds_are_claimed_than_were_searched(search, folder, capsys):
    assert main(["solve", str(folder / "11.json"), "--seconds", "60"]) == 1
    said = capsys.readouterr().err
    assert "no solution found in 2 s of search and 9 s of compiling, 256 plans tried" in said


def test_rounds_that_bring_nothing_new_are_told_once_a_second(search, folder, capsys):
    main(["solve", str(folder / "11.json")])
    assert capsys.readouterr().err.count("256 plans in 2 s") == 1


def test_of_a_folder_what_cannot_be_read_is_left_out_with_a_sentence(search, folder, capsys):
    (folder / "10.json").write_text("{")
    assert main(["solve", str(folder)]) == 1
    assert search.levels == [11, 12, 14]
    assert f"left out: {folder / '10.json'}: " in capsys.readouterr().err


def test_a_folder_of_which_nothing_can_be_read_is_an_error(search, tmp_path, capsys):
    (tmp_path / "torn.json").write_text("{")
    assert main(["solve", str(tmp_path)]) == 1
    assert not search.levels
    assert "torn.json" in capsys.readouterr().err


@pytest.fixture
def edit(search, monkeypatch):
    """Returns a function that has a level's file edited while the level is searched."""
    module = sys.modules["kinetix.environment.search.search"]
    searched = module.solve_level

    def during(path, **changes):
        def solve_level(level, **options):
            save_level(load_level(path).replace(**changes), path)
            return searched(level, **options)

        monkeypatch.setattr(module, "solve_level", solve_level)

    return during


def test_a_level_that_is_changed_during_the_search_is_left_as_it_is(edit, folder, capsys):
    path = folder / "10.json"
    edit(path, gravity=(0.0, -3.0))
    assert main(["solve", str(path), "--write"]) == 1
    assert load_level(path).gravity == (0.0, -3.0)
    assert load_level(path).solution is None
    told = capsys.readouterr()
    assert f"{path}: was changed during the search" in told.err and "recorded in" not in told.out


def test_words_that_are_changed_during_the_search_stay(edit, folder):
    path = folder / "10.json"
    edit(path, description="better words")
    assert main(["solve", str(path), "--write"]) == 0
    assert load_level(path).description == "better words"
    assert load_level(path).solution == SOLUTION


@pytest.mark.parametrize("changes", [{"gravity": (0.0, -3.0)}, {"solution": SOLUTION}])
def test_a_solution_that_came_during_the_search_is_not_dropped(edit, folder, changes):
    path = folder / "11.json"
    stale = SOLUTION.replace(actions=((9, (2, 0, 0, 0, 0, 0)),))
    save_level(load_level(path).replace(solution=stale), path)
    edit(path, **changes)
    assert main(["solve", str(path), "--write"]) == 1
    assert load_level(path).solution == changes.get("solution", stale)


def test_bundled_levels_are_not_written_to_by_name(search, tmp_path, monkeypatch, capsys):
    bundled = tmp_path / "installed" / "levels"
    (bundled / "s").mkdir(parents=True)
    path = bundled / "s" / "tried.json"
    save_level(load_level(CART).replace(solution=None, max_timesteps=10), path)
    monkeypatch.chdir(tmp_path)
    for place in ("bundled", "cli.solve"):
        monkeypatch.setattr(f"kinetix.{place}.levels_dir", lambda: bundled, raising=False)
    for word in ("s/tried", "levels/s/tried.json", "s", "levels"):
        assert main(["solve", word, "--write"]) == 1
        assert f"{word}: is bundled" in capsys.readouterr().err
    assert load_level(path).solution is None
    assert main(["solve", "s/tried"]) == 0
    monkeypatch.chdir(bundled.parent)
    assert main(["solve", "levels/s/tried.json", "--write"]) == 0
    assert load_level(path).solution == SOLUTION


def test_a_read_only_file_is_not_searched_for_what_it_cannot_take(
    search, folder, monkeypatch, capsys
):
    locked = folder / "10.json"
    # Root may write everything, whatever the mode of a file says.
    monkeypatch.setattr(os, "access", lambda path, mode: mode != os.W_OK or Path(path) != locked)
    assert main(["solve", str(folder), "--write"]) == 1
    assert search.levels == [11, 12, 14]
    assert f"left out: {locked}: cannot be saved: the file is read-only" in capsys.readouterr().err
