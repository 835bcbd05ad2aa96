"""The viewer's paths as scripts: watched, compared, measured, in the real app without a display."""

import json

import pytest

pytestmark = [pytest.mark.gl, pytest.mark.slow]


def record(tmp_path, name):
    return json.loads((tmp_path / f"{name}.json").read_text())


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
