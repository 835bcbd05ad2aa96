"""Whole runs, tiny: they learn, can be stopped at any moment, refuse what does not fit."""

import dataclasses
import math
import re
import shutil

import jax
import numpy as np
import pytest
from PIL import Image

from kinetix.agents.agent import Agent, load_agent
from kinetix.agents.checkpoint import steps_of_run
from kinetix.agents.from_card import init_parameters
from kinetix.cli import main
from kinetix.errors import KinetixError
from kinetix.level.codec import load_level, save_level
from kinetix.level.model import Body, Circle, Level
from kinetix.training.config_warnings import cut_short
from kinetix.training.curricula.pages import page_updates, read_page
from kinetix.training.logging import read_metrics
from kinetix.training.origin import read_origin
from kinetix.training.run import train
from kinetix.training.schedule import learning_rate
from kinetix.training.settings import make_config
from kinetix.training.trainer import make_trainer
from tests.training.tiny import TINY as _TINY
from tests.training.tiny import Stop as _Stop
from tests.training.tiny import same_parameters as _same_parameters
from tests.training.tiny import stop_after as _stop_after
from tests.training.tiny import tiny_config as _config
from tests.training.tiny import without_time as _without_time

pytestmark = pytest.mark.usefixtures("shared_trainers")


def test_a_run_leaves_what_is_promised(finished):
    assert sorted(path.name for path in finished.iterdir()) == [
        "checkpoints",
        "config.toml",
        "metrics.csv",
        "metrics.jsonl",
        "tensorboard",
    ]
    assert steps_of_run(finished) == [64, 128, 192]
    rows = read_metrics(finished)
    assert [row["timing/num_updates"] for row in rows] == [1, 2, 3, 4, 5, 6]
    assert all(np.isfinite(row["loss/total"]) for row in rows)
    agent = load_agent(finished)
    assert agent.card.training["environment_steps"] == 192
    assert agent.card.training["configuration"]["num_steps"] == 4
    assert agent.card.training["configuration"]["gamma"] == 0.995


def test_the_two_newest_checkpoints_keep_the_training_state(finished):
    have = [
        step for step in (64, 128, 192) if (finished / "checkpoints" / str(step) / "state").is_dir()
    ]
    assert have == [128, 192]


def test_an_interrupted_run_ends_as_if_it_had_not_been(finished, trainers, tmp_path):
    config = _config("ppo", dummy_env=True)
    for updates in (3, 5):
        with pytest.raises(_Stop):
            train("ppo", config, tmp_path / "run", report=_stop_after(updates))
    trainers.clear()  # another trainer, as in another process
    train("ppo", config, tmp_path / "run")
    assert _without_time(read_metrics(tmp_path / "run")) == _without_time(read_metrics(finished))
    _same_parameters(finished, tmp_path / "run")


def test_a_finished_run_can_be_made_longer(finished, tmp_path):
    longer = shutil.copytree(finished, tmp_path / "longer")
    train("ppo", _config("ppo", dummy_env=True, total_timesteps=8 * 4 * 8), longer)
    assert len(read_metrics(longer)) == 8


def test_a_length_that_is_behind_a_run_changes_nothing(finished, tmp_path):
    done, told = shutil.copytree(finished, tmp_path / "done"), []
    before = (done / "config.toml").read_text()
    train("ppo", _config("ppo", dummy_env=True, total_timesteps=8 * 4), done, say=told.append)
    assert any("nothing is left to do" in words for words in told)
    assert not any("now it is" in words for words in told)
    assert (done / "config.toml").read_text() == before


def test_it_is_said_where_the_levels_of_a_run_have_changed(tmp_path, trainers):
    level = load_level("s/first_flight")
    save_level(level, tmp_path / "a.json")
    small = {"dummy_env": True, "levels": (str(tmp_path / "a.json"),), "level_mode": "list"}
    out, told = tmp_path / "run", []
    train("ppo", _config("ppo", **small), out, say=told.append)
    trainers.clear()
    train("ppo", _config("ppo", **small, total_timesteps=8 * 4 * 7), out, say=told.append)
    assert not any("have changed" in words for words in told)
    save_level(level.replace(gravity=(0.0, -3.0)), tmp_path / "a.json")
    trainers.clear()
    train("ppo", _config("ppo", **small, total_timesteps=8 * 4 * 8), out, say=told.append)
    assert sum("have changed" in words for words in told) == 1
    trainers.clear()
    train("ppo", _config("ppo", **small, total_timesteps=8 * 4 * 9), out, say=told.append)
    assert sum("have changed" in words for words in told) == 1


def test_a_run_that_is_continued_elsewhere_says_what_its_levels_are_relative_to(
    finished, tmp_path, monkeypatch
):
    moved = shutil.copytree(finished, tmp_path / "moved")
    config = moved / "config.toml"
    config.write_text(re.sub("(?m)^levels = .*", 'levels = ["mine.json"]', config.read_text()))
    monkeypatch.chdir(tmp_path)
    with pytest.raises(KinetixError, match="folder in which the run was started"):
        make_config("ppo", run=moved)


def test_a_run_of_another_version_says_what_stops_it_and_what_it_adds(finished, tmp_path):
    out, told = shutil.copytree(finished, tmp_path / "run"), []
    path = out / "config.toml"
    text = path.read_text()
    path.write_text(re.sub("(?m)^(gamma|transformer_depth) = .*\n", "", text))
    config = _config("ppo", dummy_env=True)
    for _ in range(2):
        train("ppo", config, out, say=told.append)
    (warning,) = (words for words in told if words.startswith("warning"))
    assert f"{path}: does not say gamma = 0.995, transformer_depth = " in warning
    assert path.read_text() == text
    path.write_text(f"clip = 3\n{text}")
    with pytest.raises(KinetixError) as caught:
        make_config("ppo", run=out)
    assert str(caught.value).startswith(f"{path}: 'clip' is not a field of ppo")
    assert str(caught.value).endswith("without its line the run goes on")


def test_a_run_that_lost_its_checkpoints_is_not_overwritten(finished, tmp_path):
    emptied = shutil.copytree(finished, tmp_path / "emptied")
    shutil.rmtree(emptied / "checkpoints")
    with pytest.raises(KinetixError, match="metrics of 6 updates and no checkpoint"):
        train("ppo", _config("ppo", dummy_env=True), emptied)
    assert read_metrics(emptied) == read_metrics(finished)


def test_a_run_does_not_go_on_under_other_hyper_parameters(finished):
    with pytest.raises(KinetixError, match=r"started with gamma = 0\.995, now it is 0\.9"):
        train("ppo", _config("ppo", dummy_env=True, gamma=0.9), finished)
    with pytest.raises(KinetixError, match="started with ppo, not dr"):
        train("dr", _config("dr", dummy_env=True), finished)


def test_other_directories_are_left_alone(tmp_path):
    (tmp_path / "letter.txt").write_text("mine")
    with pytest.raises(KinetixError, match="is not empty and holds no training run"):
        train("ppo", _config("ppo", dummy_env=True), tmp_path)


def test_a_run_may_begin_where_its_words_are_kept(tmp_path):
    (tmp_path / "training.log").write_text("")
    config = _config("ppo", dummy_env=True)
    assert train("ppo", config, tmp_path).is_dir()


def test_starts_on_the_way_of_a_win_need_levels_and_it_is_said(tmp_path):
    told = []
    config = _config("ppo", dummy_env=True, demo_starts=0.5, level_mode="random", levels=())
    train("ppo", config, tmp_path, say=told.append)
    assert any("demo_starts = 0.5 has no effect" in words for words in told)


def test_the_command_trains_and_goes_on(tmp_path, capsys):
    flags = [
        word
        for name, value in _TINY.items()
        if name in make_config("ppo").__dataclass_fields__ or name.endswith(("depth", "width"))
        for word in (f"--{name.replace('_', '-')}", str(value))
    ]
    arguments = ["train", "ppo", "--out", str(tmp_path / "run"), "--dummy-env", *flags]
    assert main(arguments) == 0
    assert capsys.readouterr().out.strip().endswith("checkpoints/192")
    again = ["train", "ppo", "--out", str(tmp_path / "run"), "--dummy-env"]
    assert main([*again, "--total-timesteps", "224"]) == 0
    captured = capsys.readouterr()
    assert captured.out.strip().endswith("checkpoints/224")
    assert "7/7" in captured.err
    assert "MiB per environment" in captured.err


def test_fine_tuning_starts_from_the_agent(finished, tmp_path):
    teacher = load_agent(finished)
    config = _config("ppo", dummy_env=True, learning_rate=0.0, seed=5, total_timesteps=32)
    train("ppo", config, tmp_path / "tuned", teacher=teacher)
    _same_parameters(finished, tmp_path / "tuned")
    other = _config("ppo", dummy_env=True, actor_width=8)
    with pytest.raises(
        KinetixError, match="its network has actor_width = 16, the configuration's has 8"
    ):
        make_trainer(other, teacher)


def test_a_run_keeps_which_agent_it_began_from(finished, tmp_path, capsys):
    teacher, out = load_agent(finished), tmp_path / "tuned"
    config = _config("ppo", dummy_env=True, total_timesteps=64)
    began = {"name": "whole@192", "digest": teacher.digest, "environment_steps": 192}

    def fail(_):
        raise _Stop

    # Killed before its first checkpoint, it does not begin anew from something else.
    with pytest.raises(_Stop):
        train("ppo", config, out, teacher=teacher, report=fail)
    assert read_origin(out) == began
    other = Agent(teacher.card, init_parameters(teacher.card, jax.random.key(9)))
    for agent, now in ((None, "none is named"), (other, "now it is 'whole@192'")):
        with pytest.raises(KinetixError, match=f"the agent 'whole@192', {now}, and no checkpoint"):
            train("ppo", config, out, teacher=agent)
    train("ppo", config, out, teacher=teacher)
    assert load_agent(out).card.training["start_from"] == began
    # Once there is a checkpoint, the agent is needed no more.
    words = ["train", "ppo", "--out", str(out), "--dummy-env", "--from", str(tmp_path / "gone")]
    assert main([*words, "--total-timesteps", "96"]) == 0
    assert "counts at the beginning alone, which was 'whole@192'" in capsys.readouterr().err
    assert load_agent(out).card.training["start_from"] == read_origin(out) == began
    assert "start_from" not in load_agent(finished).card.training


@pytest.mark.slow
@pytest.mark.parametrize("algorithm", ["sfl", "plr", "accel", "dr"])
def test_curricula_run_and_go_on_exactly(algorithm, tmp_path):
    steps = 8 * 32 * (1 if algorithm == "sfl" else 2)
    # The filter costs compile time; one of them has it.
    changes = {"num_steps": 32, "total_timesteps": steps * 6, "filter_levels": algorithm == "sfl"}
    config = _config(algorithm, **changes)
    with pytest.raises(_Stop):
        train(algorithm, config, tmp_path / "run", report=_stop_after(3))
    third = _without_time(read_metrics(tmp_path / "run"))[2]
    # The checkpoint is of the second update, so the third is made again.
    train(algorithm, config, tmp_path / "run")
    rows = read_metrics(tmp_path / "run")
    assert len(rows) == 6
    assert _without_time(rows)[2] == third
    assert all(np.isfinite(value) for row in rows for value in row.values())
    _check_history(tmp_path / "run", rows, algorithm)
    if algorithm == "accel":
        kinds = [
            kind for row in rows for kind in ("replay", "mutate") if row[f"level_sampler/{kind}"]
        ]
        assert kinds[:2] == ["replay", "mutate"]
    if algorithm in ("plr", "accel"):
        assert any(row["level_sampler/replay"] for row in rows)
    if algorithm == "dr":
        assert all(row["level_sampler/new"] == 1 for row in rows)
    if algorithm != "sfl":
        assert rows[-1]["level_sampler/filled"] == 1.0


def _check_history(run, rows, algorithm):
    """A page an update, also over the interruption; ages and parents fit together."""
    assert page_updates(run) == [int(row["timing/num_updates"]) for row in rows]
    pages = [read_page(run, update) for update in page_updates(run)]
    seen: set[int] = set()
    for page in pages:
        head = page.head
        assert head.algorithm == algorithm and len(page.levels) == len(head.levels)
        scores = [-math.inf if one.score is None else one.score for one in head.levels]
        assert scores == sorted(scores, reverse=True)
        assert all(one.born <= head.update for one in head.levels)
        assert all(one.serial in seen for one in head.gone)
        seen |= {one.serial for one in head.levels}
    last = pages[-1].head
    # A resumed run goes on counting where the checkpoint stood.
    assert max(one.serial for one in last.levels) < sum(page.head.entered for page in pages)
    if algorithm == "accel":
        assert any(one.kind == "mutated" and one.ancestry for p in pages for one in p.head.levels)
    if algorithm == "sfl":
        assert any(one.reason == "refilled" for page in pages for one in page.head.gone)


def test_sfl_finishes_episodes_that_are_longer_than_a_rollout(tmp_path):
    ball = Body(id=1, shape=Circle(radius=0.2), position=(2.5, 0.5), role="green")
    goal = Body(id=2, shape=Circle(radius=0.2), position=(4.5, 0.5), role="blue")
    level = Level(name="far", max_timesteps=10, next_id=3, bodies=(ball, goal))
    save_level(level, tmp_path / "far.json")
    config = _config(
        "sfl", levels=(str(tmp_path / "far.json"),), level_mode="list", stagger_starts=False
    )
    trainer = make_trainer(config)
    assert trainer.setup.longest_episode == 10
    assert "rollout_steps = 8" in cut_short(trainer.setup)
    state, ended = trainer.start(), []
    for _ in range(3):
        state, metrics = trainer.update(state)
        ended.append(float(metrics["episodes"]))
    assert ended == [0, 0, 8]  # ten steps are over in the third rollout of four


def test_a_run_whose_rate_falls_goes_on_as_one_of_the_new_length(tmp_path):
    steps = _TINY["total_timesteps"] // 3
    train("ppo", _config("ppo", dummy_env=True, anneal_lr=True, total_timesteps=steps), tmp_path)
    longer, said = _config("ppo", dummy_env=True, anneal_lr=True), []
    train("ppo", longer, tmp_path, say=said.append)
    assert (
        "total_timesteps was 64, now it is 192; the learning rate goes on as in a run of that "
        "length" in said
    )
    assert len(read_metrics(tmp_path)) == 6
    # The third update learns again: its rate is 4/6 of the first, where it had come to 0.
    per_update = longer.update_epochs * longer.num_minibatches
    for updates, share in ((2, 0.0), (6, 4 / 6)):
        rate = learning_rate(longer, updates * per_update)(2 * per_update)
        assert float(rate) == pytest.approx(share * longer.learning_rate)


def test_words_tell_what_is_under_way(tmp_path):
    said, stays = [], []
    config = _config("ppo", dummy_env=True, eval_freq=3, eval_num_attempts=2)
    values = {"levels": ("s/goalkeeper",), "level_mode": "list"}
    config = dataclasses.replace(config, **values)
    train("ppo", config, tmp_path, say=stays.append, status=said.append)
    assert stays[0].startswith(
        "evaluation every 3 updates and at the end: 2 attempts each at 1 level that levels names; "
    )
    assert said[:3] == ["preparing the levels", "compiling: start", "compiling: update"]
    assert "evaluating 0/2 episodes" in said
    assert said[-1] == "evaluating 2/2 episodes"


def test_films_are_made_now_and_then(tmp_path):
    config = dataclasses.replace(
        _config("ppo", dummy_env=True, video_frequency=4),
        levels=("s/goalkeeper",),
        level_mode="list",
    )
    train("ppo", config, tmp_path)
    films = sorted(path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*.gif"))
    assert films == ["films/128/s_goalkeeper.gif", "films/192/s_goalkeeper.gif"]
    with Image.open(tmp_path / films[-1]) as film:
        assert film.size == (250, 250)
        assert getattr(film, "n_frames") > 8  # noqa: B009 (only animated pictures have it)


@pytest.mark.parametrize("algorithm", ["plr", "accel"])
def test_levels_that_are_cut_before_their_end_are_warned_about(algorithm):
    told = cut_short(make_trainer(_config(algorithm, dummy_env=True)).setup)
    assert told.startswith(
        "num_steps × outer_rollout_steps = 8 is less than the longest episode (256 steps): later "
        "steps are never learnt from"
    )
    enough = _config(algorithm, dummy_env=True, num_steps=128, total_timesteps=8 * 128 * 2)
    assert not cut_short(make_trainer(enough).setup)
