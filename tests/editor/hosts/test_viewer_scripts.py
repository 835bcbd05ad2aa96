"""The viewer's paths as scripts: watched, compared, measured, in the real app without a display."""

import json

import numpy as np
import pytest
from PIL import Image

from tests.editor.hosts.outputs import record

pytestmark = [pytest.mark.gl, pytest.mark.slow]


def differ(tmp_path, first, second):
    """The share of pixels in which two pictures differ; their left half, without messages."""
    seen = []
    for name in (first, second):
        with Image.open(tmp_path / f"{name}.png") as picture:
            seen.append(np.asarray(picture.convert("RGB"))[:, : picture.width // 2])
    return np.mean(np.any(seen[0] != seen[1], -1))


def test_an_agent_is_watched_looked_back_on_and_branched_from(
    software_gl, run_editor, script, tmp_path
):
    done = run_editor("--offscreen", "--replay", str(script("watch_agent.jsonl")), timeout=590)
    assert done.returncode == 0, done.stderr
    before, ended = record(tmp_path, "before"), record(tmp_path, "ended")
    assert (ended["mode"], ended["outcome"]) == ("ended", "won")
    scrubbed = record(tmp_path, "scrubbed")
    assert scrubbed["mode"] == "replay"
    assert scrubbed["step"] == pytest.approx(ended["step"] / 2, abs=1)
    branched = record(tmp_path, "branched")
    assert (branched["mode"], branched["step"]) == ("paused", scrubbed["step"])
    again = record(tmp_path, "ended_again")
    # From the same moment with the same memory and draws the same follows.
    assert (again["outcome"], again["step"]) == (ended["outcome"], ended["step"])
    after = record(tmp_path, "after")
    assert (after["mode"], after["level_hash"]) == ("edit", before["level_hash"])
    assert not after["dirty"]
    assert (tmp_path / "watch_taken_over.png").stat().st_size > 20_000


def test_two_players_are_compared(software_gl, run_editor, script, tmp_path):
    done = run_editor("--offscreen", "--replay", str(script("compare_agents.jsonl")), timeout=590)
    assert done.returncode == 0, done.stderr
    assert record(tmp_path, "after")["mode"] == "edit"
    for name in ("ghost", "side", "human"):
        assert (tmp_path / f"compare_{name}.png").stat().st_size > 20_000


def test_the_table_is_the_commands_and_its_attempts_open(
    software_gl, run_editor, script, tmp_path, capsys
):
    from kinetix.cli import main

    done = run_editor("--offscreen", "--replay", str(script("evaluate_agents.jsonl")), timeout=590)
    assert done.returncode == 0, done.stderr
    lines = [json.loads(line) for line in (tmp_path / "table.jsonl").read_text().splitlines()]
    command = ["eval", "--agent", "checkpoints/goalkeeper", "--levels", "s/goalkeeper", "--json"]
    assert main(command) == 0
    printed = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert lines[:2] == printed
    assert record(tmp_path, "opened")["mode"] == "replay"
    assert record(tmp_path, "opened_end")["outcome"] == "won"


def test_a_paused_episode_is_changed_played_on_kept_and_dropped(
    software_gl, run_editor, script, tmp_path
):
    done = run_editor("--offscreen", "--replay", str(script("change_paused.jsonl")), timeout=590)
    assert done.returncode == 0, done.stderr
    names = "before paused changing moved undone redone played_on kept back dropped after"
    told = {name: record(tmp_path, name) for name in names.split()}
    level = told["before"]["level_hash"]
    assert (told["paused"]["mode"], told["paused"]["level_hash"]) == ("paused", level)
    assert (told["changing"]["mode"], told["changing"]["step"]) == ("edit", told["paused"]["step"])
    assert told["moved"]["level_hash"] not in (level, told["changing"]["level_hash"])
    assert told["undone"]["level_hash"] == told["changing"]["level_hash"]
    assert told["redone"]["level_hash"] == told["moved"]["level_hash"]
    assert told["played_on"]["step"] > told["paused"]["step"]
    # The level itself changes only where the moment is kept, by one edit.
    assert told["kept"]["undo"] == f"Start from step {told['played_on']['step']}"
    assert told["kept"]["level_hash"] != level
    assert told["back"]["level_hash"] == level and not told["back"]["dirty"]
    assert (told["dropped"]["mode"], told["dropped"]["level_hash"]) == ("paused", level)
    assert (told["after"]["mode"], told["after"]["level_hash"]) == ("edit", level)


def test_attempts_are_grouped_by_their_ends_and_open_where_they_part(
    software_gl, run_editor, script, tmp_path
):
    done = run_editor("--offscreen", "--replay", str(script("attempts_part.jsonl")), timeout=590)
    assert done.returncode == 0, done.stderr
    (policy,) = record(tmp_path, "table")["policies"]
    (result,) = policy["results"]
    lost = [length for outcome, length, _ in result["episodes"] if outcome == "lost"]
    opened, played = record(tmp_path, "opened"), record(tmp_path, "played")
    # It stands still where losses leave the wins, before the end; from there it plays on.
    assert opened["mode"] == "replay" and 0 < opened["step"] <= max(lost)
    assert (played["mode"], played["outcome"]) == ("replay", "lost")
    assert differ(tmp_path, "attempts", "ways") > 0.0005
    assert differ(tmp_path, "ways", "wins") > 0.0005
    assert record(tmp_path, "after")["mode"] == "edit"


def test_policies_are_measured_from_the_gallery_compared_saved_and_opened_again(
    software_gl, run_editor, script, tmp_path
):
    done = run_editor("--offscreen", "--replay", str(script("policies.jsonl")), timeout=590)
    assert done.returncode == 0, done.stderr
    stored = record(tmp_path, "table")
    assert [policy["label"] for policy in stored["policies"]] == ["Goalkeeper", "random", "noop"]
    assert stored["leaderboard"][0]["label"] == "Goalkeeper"
    assert len(stored["differences"]) == 3
    assert "Goalkeeper" in (tmp_path / "table.html").read_text()
    # What was saved is the table that it was saved from.
    assert differ(tmp_path, "measured", "heat") > 0.002 > differ(tmp_path, "heat", "opened")
    played = record(tmp_path, "played")
    assert (played["mode"], played["outcome"]) == ("ended", "won")
    assert record(tmp_path, "after")["mode"] == "edit"


def test_an_episode_is_shared_as_a_page_and_kept_as_data(software_gl, run_editor, script, tmp_path):
    from kinetix.datasets.folder import read_dataset
    from kinetix.level.codec import load_level

    done = run_editor("--offscreen", "--replay", str(script("share_episode.jsonl")), timeout=590)
    assert done.returncode == 0, done.stderr
    ended, after = record(tmp_path, "ended"), record(tmp_path, "after")
    assert ended["mode"] == "ended" and after["mode"] == "edit"
    assert 10_000 < (tmp_path / "shared.html").stat().st_size < 200_000
    (episode,) = read_dataset(tmp_path / "episodes")
    assert (episode.source, episode.outcome) == ("person", ended["outcome"])
    assert episode.length == ended["step"] and episode.replays
    assert episode.level == load_level("s/hang_on")
