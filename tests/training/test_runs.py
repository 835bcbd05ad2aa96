"""Whole runs, tiny: they learn, can be stopped at any moment, refuse what does not fit."""

import dataclasses
import json
import math
import os
import shutil
import signal
import subprocess
import sys
import time

import jax
import numpy as np
import pytest
from PIL import Image

from kinetix.agents.agent import load_agent
from kinetix.agents.arrays import flatten
from kinetix.agents.checkpoint import steps_of_run
from kinetix.cli import main
from kinetix.errors import KinetixError
from kinetix.failures import Terminated
from kinetix.files.lock import locked_folder
from kinetix.level.codec import save_level
from kinetix.level.model import Body, Circle, Level, Polygon, Thruster
from kinetix.training.curricula.pages import page_updates, read_page
from kinetix.training.logging import read_metrics
from kinetix.training.run import make_trainer, train
from kinetix.training.schedule import learning_rate
from kinetix.training.settings import make_config

_TINY = {
    "size": "s",
    "num_train_envs": 8,
    "num_steps": 4,
    "num_minibatches": 2,
    "update_epochs": 2,
    "total_timesteps": 8 * 4 * 6,
    "eval_freq": 0,
    "checkpoint_save_freq": 2,
    "observation_type": "symbolic_flat",
    "physics": "jax2d",
    "actor_depth": 1,
    "critic_depth": 1,
    "actor_width": 16,
    "critic_width": 16,
    "batch_size": 8,
    "num_batches": 2,
    "num_to_save": 8,
    "rollout_steps": 8,
    "buffer_update_frequency": 2,
    "level_buffer_capacity": 8,
    "outer_rollout_steps": 2,
}


def _config(algorithm, **changes):
    from kinetix.agents.networks.config import NetworkConfig
    from kinetix.training.config import CONFIGS

    names = set(CONFIGS[algorithm].__dataclass_fields__) | set(NetworkConfig.__dataclass_fields__)
    values = {name: value for name, value in (_TINY | changes).items() if name in names}
    if algorithm in ("plr", "accel", "dr") and "total_timesteps" not in changes:
        values["total_timesteps"] *= 2
    return make_config(algorithm, values=values)


def _without_time(rows):
    return [
        {name: value for name, value in row.items() if name not in ("timing/sps", "timing/seconds")}
        for row in rows
    ]


def _same_parameters(a, b):
    a, b = (dict(flatten(load_agent(run).params["params"])) for run in (a, b))
    assert a.keys() == b.keys()
    for name, leaf in a.items():
        np.testing.assert_array_equal(leaf, b[name])


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A run that was never interrupted."""
    out = tmp_path_factory.mktemp("runs") / "whole"
    train("ppo", _config("ppo", dummy_env=True), out)
    return out


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


class _Stop(Exception):
    pass


def _stop_after(updates):
    def report(progress):
        if progress.update == updates:
            raise _Stop

    return report


def test_an_interrupted_run_ends_as_if_it_had_not_been(finished, tmp_path):
    config = _config("ppo", dummy_env=True)
    for updates in (3, 5):
        with pytest.raises(_Stop):
            train("ppo", config, tmp_path / "run", report=_stop_after(updates))
    train("ppo", config, tmp_path / "run")
    assert _without_time(read_metrics(tmp_path / "run")) == _without_time(read_metrics(finished))
    _same_parameters(finished, tmp_path / "run")


def _flip_a_number(checkpoint):
    """Four bytes of the state are others, and nothing of the file format can tell."""
    from kinetix.training.resume import PROGRESS, StoredProgress

    progress = json.loads((checkpoint / PROGRESS).read_text())
    assert StoredProgress(**progress).digest
    (checkpoint / PROGRESS).write_text(json.dumps(progress | {"digest": "0" * 64}))


_DAMAGES = {
    "digest": _flip_a_number,
    "progress cut": lambda folder: (folder / "progress.json").write_text('{"updates": 6, "se'),
    "progress of another type": lambda folder: (folder / "progress.json").write_text('{"a": []}'),
    "progress gone": lambda folder: (folder / "progress.json").unlink(),
    "arrays gone": lambda folder: shutil.rmtree(folder / "state" / "d"),
    "arrays cut": lambda folder: [
        path.write_bytes(path.read_bytes()[:20])
        for path in (folder / "state").rglob("*")
        if path.is_file()
    ],
    "card gone": lambda folder: ((folder / "agent.json").unlink(), shutil.rmtree(folder / "state")),
}


@pytest.mark.parametrize("damage", _DAMAGES.values(), ids=_DAMAGES)
def test_a_damaged_checkpoint_is_named_and_the_one_before_resumes(finished, tmp_path, damage):
    run = shutil.copytree(finished, tmp_path / "run")
    damage(run / "checkpoints" / "192")
    said = []
    train("ppo", _config("ppo", dummy_env=True), run, say=said.append)
    assert any("192" in text and "damaged" in text for text in said), said
    assert "resuming from update 4 of 6" in said
    assert _without_time(read_metrics(run)) == _without_time(read_metrics(finished))
    _same_parameters(finished, run)
    assert (run / "checkpoints" / "192.damaged").is_dir()


def test_no_run_starts_again_where_its_states_are_damaged(finished, tmp_path):
    run = shutil.copytree(finished, tmp_path / "run")
    for step in ("128", "192"):
        (run / "checkpoints" / step / "progress.json").write_text("")
    with pytest.raises(KinetixError, match="none of its training states can be read"):
        train("ppo", _config("ppo", dummy_env=True), run)
    assert read_metrics(run) == read_metrics(finished)
    assert steps_of_run(run) == [64, 128, 192]


def test_two_trainings_do_not_write_to_one_run(finished):
    with locked_folder(finished, "another training"):
        code = (
            "import sys; from pathlib import Path; from kinetix.errors import KinetixError\n"
            "from kinetix.files.lock import locked_folder\n"
            "try:\n    locked_folder(Path(sys.argv[1]), 'another training').__enter__()\n"
            "except KinetixError as error: print(error)\n"
        )
        done = subprocess.run(
            [sys.executable, "-c", code, str(finished)], capture_output=True, text=True, check=True
        )
    assert "another training writes here now" in done.stdout


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_training_that_is_asked_to_stop_saves_and_says_so(finished, tmp_path, number):
    said = []

    def report(progress):
        if progress.update == 3:
            os.kill(os.getpid(), number)

    config = _config("ppo", dummy_env=True)
    ends = {signal.SIGINT: KeyboardInterrupt, signal.SIGTERM: Terminated}[number]
    with pytest.raises(ends):
        train("ppo", config, tmp_path / "run", report=report, say=said.append)
    told = " ".join(said)
    assert "stopping after this update" in told
    assert "stopped after update 4; saved" in told
    # Four is a regular checkpoint; what comes next must not depend on that.
    assert len(read_metrics(tmp_path / "run")) == 4
    train("ppo", config, tmp_path / "run", say=said.append)
    assert "resuming from update 4 of 6" in said
    assert _without_time(read_metrics(tmp_path / "run")) == _without_time(read_metrics(finished))
    _same_parameters(finished, tmp_path / "run")


def test_a_disk_that_is_full_is_one_sentence(finished, tmp_path, monkeypatch):
    run = shutil.copytree(finished, tmp_path / "run")

    def full(*_, **__):
        raise ValueError("RESOURCE_EXHAUSTED: [tensorstore] No space left on device [page] [page]")

    monkeypatch.setattr("orbax.checkpoint.StandardCheckpointer.save", full)
    longer = _config("ppo", dummy_env=True, total_timesteps=8 * 4 * 8)
    with pytest.raises(KinetixError) as caught:
        train("ppo", longer, run)
    assert str(caught.value).endswith("cannot be written: No space left on device")
    assert steps_of_run(run) == [64, 128, 192]


def test_a_finished_run_can_be_made_longer(finished, tmp_path):
    longer = shutil.copytree(finished, tmp_path / "longer")
    train("ppo", _config("ppo", dummy_env=True, total_timesteps=8 * 4 * 8), longer)
    assert len(read_metrics(longer)) == 8


def test_a_run_does_not_go_on_under_other_hyper_parameters(finished):
    with pytest.raises(KinetixError, match=r"started with gamma = 0\.995, now it is 0\.9"):
        train("ppo", _config("ppo", dummy_env=True, gamma=0.9), finished)
    with pytest.raises(KinetixError, match="started with ppo, not dr"):
        train("dr", _config("dr", dummy_env=True), finished)


def test_other_directories_are_left_alone(tmp_path):
    (tmp_path / "letter.txt").write_text("mine")
    with pytest.raises(KinetixError, match="is not empty and holds no training run"):
        train("ppo", _config("ppo", dummy_env=True), tmp_path)


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
        assert [one.score for one in head.levels] == sorted(
            (one.score for one in head.levels), reverse=True
        )
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


@pytest.mark.slow
def test_killed_at_random_moments_a_run_ends_the_same(tmp_path):
    """SIGKILL, twenty times; the metrics are those of a run that was left alone."""
    flags = [
        word
        for name, value in (_TINY | {"total_timesteps": 8 * 4 * 240}).items()
        if name in make_config("ppo").__dataclass_fields__ or name.endswith(("depth", "width"))
        for word in (f"--{name.replace('_', '-')}", str(value))
    ]

    def command(out):
        train_ppo = [sys.executable, "-m", "kinetix", "train", "ppo", "--dummy-env"]
        return [*train_ppo, "--out", str(out), *flags]

    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    subprocess.run(command(tmp_path / "whole"), check=True, **quiet)
    random = np.random.default_rng(0)
    kills = {"starting": 0, "training": 0}
    saved = 0
    for attempt in range(20):
        process = subprocess.Popen(command(tmp_path / "killed"), **quiet)
        began = len(read_metrics(tmp_path / "killed"))
        # Every fifth dies while it starts and reads what is there; the others train for a while.
        if attempt % 5 == 4:
            time.sleep(float(random.uniform(0, 3)))
        else:
            while process.poll() is None and len(read_metrics(tmp_path / "killed")) <= began:
                time.sleep(0.01)
            time.sleep(float(random.uniform(0, 0.4)))
        assert process.poll() is None, "the run was over before it could be killed"
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
        rows = len(read_metrics(tmp_path / "killed"))
        kills["training" if rows > began else "starting"] += 1
        # One checkpoint interval is two updates, and what was saved once is never lost.
        newest = max(steps_of_run(tmp_path / "killed"), default=0) // 32
        assert max(saved, rows - 2) <= newest
        saved = newest
    assert min(kills.values()) > 0
    subprocess.run(command(tmp_path / "killed"), check=True, **quiet)
    whole, killed = (_without_time(read_metrics(tmp_path / n)) for n in ("whole", "killed"))
    assert killed == whole
    _same_parameters(tmp_path / "whole", tmp_path / "killed")
    card = json.loads((tmp_path / "killed" / "checkpoints" / "7680" / "agent.json").read_text())
    assert card["training"]["environment_steps"] == 7680


def _rocket():
    """A box with a thruster below a blue ball: random play reaches it now and then."""
    corners = ((-0.2, -0.2), (0.2, -0.2), (0.2, 0.2), (-0.2, 0.2))
    box = Body(id=1, shape=Polygon(vertices=corners), position=(2.5, 0.45), role="green")
    ball = Body(id=2, shape=Circle(radius=0.3), position=(2.5, 2.5), fixed=True, role="blue")
    up = Thruster(id=3, body=1, position=(0.0, -0.2), angle=math.pi / 2, power=0.24)
    return Level(name="rocket", size="s", next_id=4, bodies=(box, ball), thrusters=(up,))


@pytest.mark.slow
def test_ppo_learns_an_easy_level(tmp_path):
    """A fixed budget on one level of size s; the last evaluation solves at least 0.8."""
    save_level(_rocket(), tmp_path / "rocket.json")
    config = make_config(
        "ppo",
        preset="small",
        values={
            "levels": (str(tmp_path / "rocket.json"),),
            "total_timesteps": 196_608,
            "eval_freq": 1000,
            "eval_num_attempts": 50,
            "checkpoint_save_freq": 1000,
        },
    )
    train("ppo", config, tmp_path / "run")
    assert read_metrics(tmp_path / "run")[-1]["eval/hand_designed_episode_solve_rate"] >= 0.8


def _sfl_on(path, **changes):
    """A tiny SFL whose only source of levels is a file, in an environment that does nothing."""
    save_level(_rocket(), path)
    levels = {"levels": (str(path),), "size": "s", "dummy_env": True}
    return make_trainer(_config("sfl", num_to_save=4, **levels, **changes))


@pytest.mark.slow
def test_sfl_trains_on_a_fixed_set_and_measures_what_that_changes(tmp_path):
    trainer = _sfl_on(
        tmp_path / "rocket.json",
        train_on_buffer=True,
        train_buffer_size=5,
        log_learnability_before_after=True,
    )
    state = trainer.start()
    reports = []
    for _ in range(3):
        state, metrics = trainer.update(state)
        reports.append({name for name in metrics if name.startswith("sfl/")})
    chosen = {"sfl/buffer_learnability", "sfl/sampled_learnability"}
    before = {"sfl/learnability_before", "sfl/solve_rate_before"}
    after = {"sfl/learnability_after", "sfl/solve_rate_after"}
    assert reports == [chosen | before, set(), chosen | before | after]
    assert state.pool.timestep.shape == (5,)


@pytest.mark.slow
def test_sfl_can_be_given_the_evaluation_levels(tmp_path):
    other = _rocket().replace(name="other", gravity=(0.0, -3.0))
    save_level(other, tmp_path / "other.json")
    given = {"put_eval_levels_in_buffer": True, "eval_levels": (str(tmp_path / "other.json"),)}
    trainer = _sfl_on(tmp_path / "rocket.json", **given)
    state, _ = trainer.update(trainer.start())
    gravity = np.asarray(state.chosen.levels.world.gravity[:, 1])
    np.testing.assert_allclose(gravity, [-9.81, -9.81, -9.81, -3.0], rtol=1e-3)
    with pytest.raises(KinetixError, match="do not fit a buffer of num_to_save = 4"):
        _sfl_on(tmp_path / "rocket.json", **given | {"eval_levels": ("s/first_flight",) * 5})


def test_entities_can_change_their_slots(tmp_path):
    trainer = _sfl_on(tmp_path / "rocket.json", permute_state_during_training=True)
    reset = jax.jit(jax.vmap(trainer.setup.reset_fn))
    slots = np.asarray(reset(jax.random.split(jax.random.key(0), 16)).world.bodies.active)
    # The rocket's only circle is the blue ball; it lies in either of the two slots of circles.
    assert {tuple(row) for row in slots[:, 5:]} == {(True, False), (False, True)}
    same = trainer.setup.arranged(
        state := reset(jax.random.split(jax.random.key(0), 16)), jax.random.key(1)
    )
    moved = np.asarray(same.world.bodies.active[:, 5:] != state.world.bodies.active[:, 5:])
    assert moved.any() and not moved.all()


@pytest.mark.slow
def test_sfl_keeps_more_learnable_levels_than_it_samples():
    config = _config(
        "sfl",
        batch_size=128,
        num_to_save=32,
        rollout_steps=128,
        num_steps=8,
        total_timesteps=8 * 8 * 2,
        learnability_correction=False,
        filter_levels=False,
    )
    trainer = make_trainer(config)
    _, metrics = trainer.update(trainer.start())
    assert float(metrics["sfl/buffer_learnability"]) > 2 * float(
        metrics["sfl/sampled_learnability"]
    )
    # Means of episodes are NaN here: none ends within so short a rollout.
    losses = [value for name, value in metrics.items() if name.startswith("loss/")]
    assert np.all(np.isfinite(losses))


def test_sfl_finishes_episodes_that_are_longer_than_a_rollout(tmp_path):
    ball = Body(id=1, shape=Circle(radius=0.2), position=(2.5, 0.5), role="green")
    goal = Body(id=2, shape=Circle(radius=0.2), position=(4.5, 0.5), role="blue")
    level = Level(name="far", max_timesteps=10, next_id=3, bodies=(ball, goal))
    save_level(level, tmp_path / "far.json")
    config = _config("sfl", levels=(str(tmp_path / "far.json"),), level_mode="list")
    trainer = make_trainer(config)
    assert trainer.setup.longest_episode == 10
    assert "rollout_steps = 8" in trainer.setup.cut_short()
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
    said = []
    config = _config("ppo", dummy_env=True, eval_freq=3, eval_num_attempts=2)
    values = {"levels": ("s/goalkeeper",), "level_mode": "list"}
    config = dataclasses.replace(config, **values)
    train("ppo", config, tmp_path, status=said.append)
    assert said[:2] == ["compiling: start", "compiling: update"]
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
    told = make_trainer(_config(algorithm, dummy_env=True)).setup.cut_short()
    assert told.startswith(
        "num_steps × outer_rollout_steps = 8 is less than the longest episode (256 steps): later "
        "steps are never learnt from"
    )
    enough = _config(algorithm, dummy_env=True, num_steps=128, total_timesteps=8 * 128 * 2)
    assert not make_trainer(enough).setup.cut_short()
