"""Sweeps: which runs a table means, what is refused, and the table of results."""

import csv
import json
import sys

import pytest

from kinetix.cli import main
from kinetix.errors import KinetixError
from kinetix.training.sweep import lines, read_sweep, table, write_table


def _read(tmp_path, text):
    path = tmp_path / "sweep.toml"
    path.write_text(text)
    return read_sweep(path)


def test_a_grid_is_all_combinations(tmp_path):
    runs = _read(tmp_path, "[grid]\nlearning_rate = [1e-3, 3e-4]\ngamma = [0.9, 0.99, 0.995]\n")
    assert len(runs) == 6
    assert runs[0].name == "learning_rate=0.001,gamma=0.9"
    assert runs[-1].values == {"learning_rate": 3e-4, "gamma": 0.995}


def test_listed_runs_go_with_the_grid(tmp_path):
    text = """
        [grid]
        seed = [0, 1]
        [[run]]
        name = "flat"
        observation_type = "symbolic_flat"
        [[run]]
        levels = ["s/goalkeeper", "s/wheelie"]
    """
    assert [run.name for run in _read(tmp_path, text)] == [
        "flat,seed=0",
        "flat,seed=1",
        "levels=s_goalkeeper+s_wheelie,seed=0",
        "levels=s_goalkeeper+s_wheelie,seed=1",
    ]


def test_draws_are_the_same_every_time(tmp_path):
    text = """
        [random]
        samples = 50
        learning_rate = { low = 1e-5, high = 1e-2, log = true }
        num_steps = { low = 8, high = 64 }
        gamma = [0.9, 0.99]
    """
    runs = _read(tmp_path, text)
    assert runs == _read(tmp_path, text)
    rates = [run.values["learning_rate"] for run in runs]
    assert min(rates) < 1e-4 < 1e-3 < max(rates)
    assert all(1e-5 <= rate <= 1e-2 for rate in rates)
    steps = {run.values["num_steps"] for run in runs}
    assert all(type(each) is int and 8 <= each <= 64 for each in steps)
    assert {run.values["gamma"] for run in runs} == {0.9, 0.99}


def test_no_two_draws_are_equal(tmp_path):
    few = "[random]\nsamples = 6\nnum_steps = [32, 64]\nseed = { low = 0, high = 2 }\n"
    runs = _read(tmp_path, few)
    assert len({run.name for run in runs}) == len(runs) == 6
    with pytest.raises(KinetixError, match=r"random\.samples: expected fewer: only 6 different"):
        _read(tmp_path, few.replace("samples = 6", "samples = 7"))


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", r"expected a table \[grid\], \[random\] or \[\[run\]\] with values"),
        ("[gird]\ngamma = [0.9]", "gird: did you mean 'grid'"),
        ("grid = 3", "grid: expected a table"),
        ("[grid]\ngamma = 0.9", "grid.gamma: expected a list of values"),
        ("[grid]\ngamma = [0.9, 0.9]", "two runs are called 'gamma=0.9'"),
        ("[random]\ngamma = [0.9]", "random.samples: expected a number of draws"),
        (
            "[random]\nsamples = 2\ngamma = {low = 1.0, high = 0.9}",
            "random.gamma: expected low < high",
        ),
        ("[random]\nsamples = 2\ngamma = {low = 0.0, high = 0.9, log = true}", "expected 0 < low"),
        ("[random]\nsamples = 2\ngamma = {min = 0.0, high = 0.9}", "low = …, high = …"),
        ("[run]\ngamma = 0.9", r"tables that begin with \[\[run\]\]"),
        ("[grid\n", "not valid TOML"),
    ],
)
def test_what_cannot_be_meant_is_one_sentence(tmp_path, text, sentence):
    with pytest.raises(KinetixError, match=sentence):
        _read(tmp_path, text)


def test_results_are_means_over_seeds_and_the_best_stands_first(tmp_path):
    runs = _read(tmp_path, "[grid]\ngamma = [0.9, 0.99, 0.995]\n")

    def trained(folder, solved, **more):
        folder.mkdir(parents=True)
        row = {
            "timing/num_updates": 1,
            "timing/num_env_steps": 64,
            "average/episode_solved": solved,
        }
        (folder / "metrics.jsonl").write_text(json.dumps(row | more) + "\n")

    trained(tmp_path / "gamma=0.9", 0.9, **{"eval/hand_designed_episode_solve_rate": 0.25})
    for seed, solved in enumerate((0.5, 1.0)):
        trained(tmp_path / "gamma=0.99" / f"seed_{seed}", solved)
    rows = table(tmp_path, runs)
    assert [row["run"] for row in rows] == ["gamma=0.99", "gamma=0.9", "gamma=0.995"]
    assert [row.get("solve_rate") for row in rows] == [0.75, 0.25, None]
    assert rows[0]["seeds"] == 2
    text = list(lines(rows))
    assert text[1].split() == ["0.750", "–", "64", "gamma=0.99"]
    assert text[3].split() == ["–", "–", "–", "gamma=0.995"]


def test_runs_of_a_sweep_that_was_changed_stay_in_the_table(tmp_path):
    write_table(tmp_path, _read(tmp_path, "[grid]\ngamma = [0.9, 0.99]\nlevels = [['a', 'b']]\n"))
    kept, gone = "gamma=0.9,levels=a+b", "gamma=0.99,levels=a+b"
    assert gone in (tmp_path / "sweep.csv").read_text()
    (tmp_path / kept).mkdir()
    row = {"timing/num_updates": 1, "timing/num_env_steps": 64, "average/episode_solved": 0.5}
    (tmp_path / kept / "metrics.jsonl").write_text(json.dumps(row) + "\n")
    for _ in range(2):
        write_table(tmp_path, _read(tmp_path, "[grid]\nseed = [1]\n"))
        with (tmp_path / "sweep.csv").open() as file:
            rows = {row.pop("run"): row for row in csv.DictReader(file)}
        assert list(rows) == [kept, "seed=1"]
        assert rows[kept]["levels"] == '["a", "b"]' and rows[kept]["gamma"] == "0.9"
        assert rows[kept]["solve_rate"] == "0.5" and rows["seed=1"]["solve_rate"] == ""


_NUMBERS = {"num-train-envs": 8, "num-steps": 4, "num-minibatches": 2, "update-epochs": 1}
_NUMBERS |= {"total-timesteps": 64, "eval-freq": 0, "size": "s", "physics": "jax2d"}
_NUMBERS |= {"actor-depth": 1, "critic-depth": 1, "actor-width": 8, "critic-width": 8}
_TINY = ["--dummy-env", *(word for name, x in _NUMBERS.items() for word in (f"--{name}", str(x)))]


def test_the_command_trains_every_run_and_goes_on(tmp_path, capsys):
    sweep = tmp_path / "sweep.toml"
    sweep.write_text("[grid]\ngamma = [0.9, 0.99]\n")
    out = tmp_path / "out"
    words = ["train", "ppo", "--out", str(out), "--sweep", str(sweep), *_TINY]
    assert main(words) == 0
    told = capsys.readouterr()
    assert "1/2: " in told.err
    assert "1/2  32 steps  –/s" in told.err  # most of its time was compilation
    assert len(told.out.strip().splitlines()) >= 3
    with (out / "sweep.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert {row["gamma"] for row in rows} == {"0.9", "0.99"}
    assert {row["steps"] for row in rows} == {"64"}
    assert list(rows[0]) == ["run", "gamma", "solve_rate", "return", "steps", "seeds"]
    # The same command finds everything done.
    assert main(words) == 0
    assert "1/2  " not in capsys.readouterr().err
    assert main([*words, "--gamma", "0.5"]) == 1
    assert "sets gamma, and so does --gamma" in capsys.readouterr().err
    sweep.write_text("[grid]\ngama = [0.9, 0.99]\n")
    assert main(words) == 1
    assert "gama=0.9: gama: ppo has no such field; did you mean 'gamma'?" in capsys.readouterr().err


def test_a_sweep_from_an_agent_is_checked_with_it_before_the_first_run(finished, tmp_path, capsys):
    sweep, out = tmp_path / "sweep.toml", tmp_path / "out"
    sweep.write_text('[[run]]\nname = "a"\n[[run]]\nname = "b"\nkind = "relational"\n')
    words = ["train", "ppo", "--out", str(out), "--dummy-env", "--sweep", str(sweep)]
    assert main([*words, "--from", str(finished)]) == 1
    assert "b: observation_type" in capsys.readouterr().err
    assert not out.exists()


def test_a_sweep_whose_first_run_is_refused_at_its_start_goes_on(monkeypatch, tmp_path, capsys):
    begun = []

    def refuse(algorithm, config, out, teacher, terminal):
        begun.append(out.name)
        raise KinetixError("not this one")

    monkeypatch.setattr("kinetix.cli.train._train", refuse)
    sweep = tmp_path / "sweep.toml"
    sweep.write_text("[grid]\ngamma = [0.9, 0.99]\n")
    words = ["train", "ppo", "--out", str(tmp_path / "out"), "--sweep", str(sweep), *_TINY]
    assert main(words) == 1
    assert begun == ["gamma=0.9", "gamma=0.99"]
    assert capsys.readouterr().err.count("not this one") == 2


def test_seeds_that_were_not_reached_keep_the_preset(tmp_path, capsys):
    """Seeds begun later than the first must not get other hyper-parameters."""
    from kinetix.training.settings import loads_config

    out = tmp_path / "out"
    words = ["train", "ppo", "--out", str(out), *_TINY]
    assert main([*words, "--seeds", "1"]) == 0
    both = tmp_path / "both"
    both.mkdir()
    out.rename(both / "seed_0")
    assert main(["train", "ppo", "--out", str(both), *_TINY, "--seeds", "2"]) == 0
    values = [
        loads_config((both / f"seed_{seed}" / "config.toml").read_text(), "")[1] for seed in (0, 1)
    ]
    assert values[0] | {"seed": 1} == values[1]
    capsys.readouterr()


def test_seeds_count_from_the_one_that_a_file_names(tmp_path):
    from kinetix.cli.train import Common, _runs

    file = tmp_path / "mine.toml"
    file.write_text("seed = 100\n")
    command = Common(config=file, seeds=2, out=tmp_path / "out")
    assert [path.name for path in _runs("ppo", command, {}, None)] == ["seed_100", "seed_101"]
    assert [path.name for path in _runs("ppo", command, {"seed": 7}, None)] == ["seed_7", "seed_8"]


def test_evaluation_levels_without_room_are_refused_at_once(tmp_path, capsys):
    """At the first evaluation, all that was learnt since the last checkpoint would be lost."""
    words = ["train", "ppo", "--out", str(tmp_path / "out"), *_TINY, "--eval-freq", "2"]
    words += ["--observation-type", "symbolic_flat", "--eval-levels", "l/rover_ridge"]
    for more in ([], ["--eval-freq", "0", "--video-frequency", "2"]):
        assert main([*words, *more]) == 1
        assert "eval_levels: l/rover_ridge has l (polygons" in capsys.readouterr().err
    assert not (tmp_path / "out" / "checkpoints").exists()


@pytest.mark.parametrize("several", ["--seeds", "--sweep"])
def test_several_runs_do_not_mix_with_one(tmp_path, capsys, several):
    (tmp_path / "sweep.toml").write_text("[grid]\ngamma = [0.9, 0.95]\n")
    out = tmp_path / "out"
    out.mkdir()
    (out / "config.toml").write_text('algorithm = "ppo"\n')
    value = "2" if several == "--seeds" else str(tmp_path / "sweep.toml")
    assert main(["train", "ppo", "--out", str(out), *_TINY, several, value]) == 1
    assert "holds a training run, and several runs would mix" in capsys.readouterr().err
    assert [path.name for path in out.iterdir()] == ["config.toml"]


def test_a_package_that_is_missing_is_told_before_anything_is_made(tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "wandb", None)
    out = tmp_path / "out"
    assert main(["train", "ppo", "--out", str(out), *_TINY, "--wandb-project", "mine"]) == 1
    assert "the package wandb is missing" in capsys.readouterr().err
    assert not out.exists()


def test_runs_with_many_values_are_told_apart(tmp_path):
    fields = [f"a_rather_long_hyper_parameter_{k} = [{k}]" for k in range(6)]
    text = "\n".join(["[grid]", *fields, "the_last = [true, false]", "[[run]]", 'name = "flat"'])
    names = [run.name for run in _read(tmp_path, text)]
    assert len(set(names)) == 2 and max(map(len, names)) <= 120
