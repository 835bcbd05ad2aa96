"""Configurations: where values come from, what is refused, and back to TOML."""

import dataclasses
import math
from pathlib import Path

import pytest

from kinetix.agents.networks.config import NetworkConfig
from kinetix.errors import KinetixError
from kinetix.level.codec import load_level, save_level
from kinetix.level.sizes import capacity_of, parse_capacity
from kinetix.training.config import BcConfig
from kinetix.training.devices import check_divisible
from kinetix.training.settings import dumps_config, field_notes, loads_config, make_config, presets
from tests.training.tiny import tiny_config


def test_the_defaults_are_the_published_ones():
    ppo, sfl = make_config("ppo"), make_config("sfl")
    accel, dr = make_config("accel"), make_config("dr")
    assert (ppo.learning_rate, ppo.gamma, ppo.gae_lambda, ppo.clip_eps) == (5e-5, 0.995, 0.9, 0.2)
    assert (ppo.num_train_envs, ppo.num_steps, ppo.num_minibatches) == (2048, 64, 32)
    assert ppo.num_updates == 10_737_418_240 // (64 * 2048)
    assert (sfl.num_steps, sfl.batch_size * sfl.num_batches, sfl.num_to_save) == (
        256,
        262_144,
        8192,
    )
    assert (accel.use_accel, accel.num_edits, accel.score_function) == (True, 5, "MaxMC")
    assert (dr.replay_prob, dr.size) == (0.0, "s")


@pytest.mark.parametrize("algorithm", ["ppo", "sfl", "plr", "accel", "dr"])
@pytest.mark.parametrize("preset", presets())
def test_presets_are_valid_and_come_back_from_toml(algorithm, preset):
    config = make_config(algorithm, preset=preset)
    name, values = loads_config(dumps_config(algorithm, config), "test")
    assert name == algorithm
    assert make_config(name, values=values) == config


def test_later_sources_win(tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text("num_steps = 8\nseed = 3\n[sfl]\nnum_steps = 4\n[network]\nactor_depth = 1\n")
    config = make_config("sfl", preset="small", file=file, values={"seed": 9, "actor_width": 7})
    assert (config.num_steps, config.seed, config.num_train_envs) == (4, 9, 256)
    assert (config.network.actor_depth, config.network.actor_width) == (1, 7)
    assert config.network.kind == "flat_mlp"
    assert make_config("ppo", preset="small", file=file).num_steps == 8


def test_parity_brings_what_belongs_to_it():
    config = make_config("ppo", preset="kinetix-3")
    assert (config.physics, config.bootstrap_on_timeout) == ("jax2d", False)


def test_levels_bring_the_mode_and_the_size():
    config = make_config("ppo", values={"levels": ("s/wheelie", "m/touchdown")})
    assert config.level_mode == "list"
    assert make_config("ppo", values={"levels": "s/goalkeeper"}).levels == ("s/goalkeeper",)
    assert len(config.size.split(",")) == 4
    named = Path("levels") / "s" / "goalkeeper.json"
    assert make_config("ppo", values={"eval_levels": [named]}).eval_levels == (str(named),)


def test_imitation_has_no_environments_to_divide():
    values = {"data": ("s/first_flight",), "num_minibatches": 3}
    assert make_config("bc", values=values).num_minibatches == 3


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"num_minibatches": 30}, "num_minibatches = 30 must divide num_train_envs = 2048"),
        (
            {"num_minibatches": 30, "full_minibatch_shuffle": True},
            "num_minibatches = 30 must divide num_train_envs = 2048 times num_steps = 64",
        ),
        ({"total_timesteps": 10}, "total_timesteps = 10 is less than one update"),
        ({"total_timesteps": 10**16}, r"total_timesteps = 1\d+ is more than 2 000 000 000 updates"),
        ({"observation_type": "smell"}, "observation_type: 'smell' is none of the choices"),
        ({"num_steps": 0}, "num_steps: expected at least 1"),
        ({"checkpoint_save_freq": 0}, "checkpoint_save_freq: expected at least 1, got 0"),
        ({"video_frequency": -1}, "video_frequency: expected at least 0, got -1"),
        ({"eval_freq": -4}, "eval_freq: expected at least 0, got -4"),
        ({"gamma": "much"}, r"\$\.gamma: expected a number, got a string"),
        ({"anneal_lr": True, "warmup_lr": True}, "choose one of them"),
        (
            {"full_minibatch_shuffle": True, "recurrent_model": True},
            "cannot be used with recurrent",
        ),
        ({"level_mode": "list"}, "needs levels"),
        (
            {"learning_rate": -1.0},
            r"learning_rate: expected a finite number, at least 0, got -1\.0",
        ),
        (
            {"learning_rate": math.nan},
            "learning_rate: expected a finite number, at least 0, got nan",
        ),
        ({"gamma": 1.5}, r"gamma: expected 0 … 1, got 1\.5"),
        ({"clip_eps": 0.0}, "clip_eps: expected a finite number above 0"),
        ({"ent_coef": math.inf}, "ent_coef: expected a finite number, got inf"),
        ({"seed": -1}, "seed: expected 0 … 4294967295, got -1"),
        ({"levels": "s/goalkeper"}, "did you mean 's/goalkeeper'"),
        ({"eval_levels": ("s/goalkeper",)}, "did you mean 's/goalkeeper'"),
        ({"eval_levels": [math.inf]}, "eval_levels: expected names of levels, files .*, got inf"),
        ({"levels": [["s/goalkeeper"]]}, r"levels: expected names of levels, files .*, got \["),
        ({"levels": 3}, "levels: expected names of levels, files .*, got 3"),
        ({"size": ["s"]}, r"size \['s'\]: expected s, m, l"),
        ({"size": "xl"}, "size 'xl': expected s, m, l"),
        ({"num_heads": 6}, "num_heads: expected a multiple of 4"),
    ],
)
def test_what_cannot_work_is_refused(values, sentence):
    with pytest.raises(KinetixError, match=sentence):
        make_config("ppo", values=values)


@pytest.mark.parametrize(
    ("algorithm", "name"),
    [("sfl", "buffer_update_frequency"), ("sfl", "num_batches"), ("plr", "outer_rollout_steps")],
)
def test_numbers_of_curricula_are_refused_too(algorithm, name):
    with pytest.raises(KinetixError, match=f"{name}: expected at least 1, got 0"):
        make_config(algorithm, values={name: 0})


def test_sfl_cannot_save_more_than_it_scores():
    with pytest.raises(KinetixError, match="num_to_save = 8192 is more than"):
        make_config("sfl", values={"num_batches": 1, "batch_size": 64})


def test_sfl_needs_an_environment_for_what_it_scores():
    with pytest.raises(KinetixError, match="num_train_envs = 1 is less than one environment"):
        tiny_config("sfl", num_train_envs=1, num_minibatches=1)
    lone = tiny_config("sfl", num_train_envs=1, num_minibatches=1, sampled_envs_ratio=0.0)
    assert lone.drawn_envs == 0


def test_levels_that_sfl_scores_need_equal_shares_too():
    config = tiny_config("sfl", batch_size=15, num_to_save=9)
    assert config.uneven(2) == "batch_size = 15 must be a multiple of the 2 devices"
    assert not config.fits_devices(2) and config.fits_devices(1)
    config = tiny_config("sfl", batch_size=16, num_to_save=9)
    assert config.fits_devices(2)
    measured = dataclasses.replace(config, log_learnability_before_after=True)
    assert measured.uneven(2) == "num_to_save = 9 must be a multiple of the 2 devices"


def test_imitation_is_refused_on_no_number_of_devices(monkeypatch):
    monkeypatch.setattr("jax.device_count", lambda: 3)
    config = make_config("bc", values={"data": ("s/first_flight",)})
    assert config.num_train_envs % 3
    check_divisible(config)
    assert not config.fits_devices(3)  # one core is enough
    with pytest.raises(KinetixError, match="num_train_envs = 2048 must be a multiple of the 3"):
        check_divisible(make_config("ppo"))


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("num_step = 3", "'num_step' is not a field of ppo; did you mean 'num_steps'"),
        ("[network]\nactor_dept = 3", "did you mean 'actor_depth'"),
        ("num_steps = ", "not valid TOML"),
    ],
)
def test_bad_files_are_refused(tmp_path, text, sentence):
    file = tmp_path / "bad.toml"
    file.write_text(text)
    with pytest.raises(KinetixError, match=sentence):
        make_config("ppo", file=file)


def test_unknown_names_are_refused(tmp_path):
    with pytest.raises(KinetixError, match="expected one of bc, ppo, sfl, plr, accel, dr"):
        make_config("dqn")
    with pytest.raises(KinetixError, match="expected one of general, kinetix-3, paper"):
        make_config("ppo", preset="huge")
    with pytest.raises(KinetixError, match="cannot be read"):
        make_config("ppo", file=tmp_path / "nowhere.toml")


def test_every_field_has_a_note():
    notes = field_notes(type(make_config("sfl")))
    assert notes["batch_size"] == "Random levels that are scored at once."
    assert notes["learning_rate"].startswith("Step size of Adam")
    assert all(notes.values())


def test_a_configuration_knows_its_algorithm():
    from kinetix.training.config import CONFIGS, algorithm_of

    values = {"bc": {"data": ("s/goalkeeper",)}}
    found = {name: algorithm_of(make_config(name, values=values.get(name))) for name in CONFIGS}
    assert found == {name: name for name in CONFIGS}


def test_the_papers_numbers_come_with_the_papers_environment():
    config = make_config("ppo", preset="paper")
    assert (config.parity, config.physics, config.size) == ("kinetix-3", "jax2d", "s")
    assert config.num_train_envs == 2048


def test_a_field_that_does_not_exist_is_not_ignored():
    with pytest.raises(KinetixError, match="num_train_env: ppo has no such field; did you mean"):
        make_config("ppo", values={"num_train_env": 3})


@pytest.mark.parametrize(
    ("flags", "observation", "kind"),
    [
        ({"kind": "relational"}, "symbolic_entity", "relational"),
        ({"kind": "cnn"}, "pixels", "cnn"),
        ({"observation_type": "symbolic_entity"}, "symbolic_entity", "entity_transformer"),
        ({"observation_type": "blind"}, "blind", "flat_mlp"),
        ({}, "symbolic_flat", "flat_mlp"),
    ],
)
def test_network_and_observation_follow_each_other(flags, observation, kind):
    config = make_config("ppo", preset="small", values=flags)
    assert (config.observation_type, config.network.kind) == (observation, kind)


def test_accel_mutates_the_levels_that_are_named():
    assert make_config("accel").accel_start_from_empty
    named = {"levels": ["s/wheelie"]}
    assert not make_config("accel", values=named).accel_start_from_empty
    assert not make_config("accel", values={"level_mode": "locomotion"}).accel_start_from_empty
    wanted = named | {"accel_start_from_empty": True}
    assert make_config("accel", values=wanted).accel_start_from_empty


@pytest.mark.parametrize("form", [dataclasses.asdict, lambda network: network])
def test_a_whole_network_is_taken_over(form):
    network = NetworkConfig(kind="flat_mlp", actor_width=512)
    config = make_config("ppo", preset="small", values={"network": form(network)})
    assert config.network == network
    both = {"network": form(network), "actor_width": 64}
    assert make_config("ppo", preset="small", values=both).network.actor_width == 64
    with pytest.raises(KinetixError, match="network: expected a NetworkConfig or a mapping, got 5"):
        make_config("ppo", values={"network": 5})


def test_a_network_that_cannot_read_the_observation_is_refused():
    flags = {"kind": "relational", "observation_type": "symbolic_flat"}
    with pytest.raises(KinetixError, match="a network of the kind relational reads symbolic_ent"):
        make_config("ppo", preset="small", values=flags)


def test_columns_that_the_relational_network_looks_up_are_not_normalised():
    told = {"kind": "relational", "rms_norm": True}
    with pytest.raises(KinetixError, match="rms_norm: the relational network"):
        make_config("ppo", preset="small", values=told)


def test_levels_that_are_too_large_for_a_presets_size_have_their_own():
    assert make_config("ppo", preset="small", values={"levels": ["s/wheelie"]}).size == "s"
    assert make_config("ppo", preset="small", values={"levels": ["m/salute"]}).size == "6,3,2,2"
    told = {"levels": ["m/salute"], "size": "s"}
    assert make_config("ppo", preset="small", values=told).size == "s"


def test_demonstrations_that_are_too_large_for_a_presets_size_have_their_own():
    large = {"data": ("m/touchdown", "s/goalkeeper")}
    config = make_config("bc", preset="small", values=large)
    room = parse_capacity(config.size)
    levels = [load_level(name) for name in large["data"]]
    assert all(room.covers(capacity_of(level)) for level in levels)
    assert make_config("bc", preset="small", values={"data": ("s/goalkeeper",)}).size == "s"
    assert make_config("bc", preset="small", values={**large, "size": "l"}).size == "l"


def test_the_preset_leaves_imitation_its_own_defaults():
    config = make_config("bc", preset="small", values={"data": ("s/goalkeeper",)})
    for name in ("learning_rate", "total_timesteps", "minibatch_size"):
        assert getattr(config, name) == getattr(BcConfig, name)


def test_demonstrations_are_played_under_their_physics_whatever_the_preset(tmp_path):
    level = load_level("s/goalkeeper")
    solution = level.solution.replace(physics="fast", frame_skip=4)
    data, file = tmp_path / "level.json", tmp_path / "mine.toml"
    save_level(level.replace(solution=solution), data)
    file.write_text('physics = "accurate"\nframe_skip = 1\n')

    def physics(**sources):
        values = {"data": (str(data),)} | sources.pop("values", {})
        config = make_config("bc", values=values, **sources)
        return config.physics, config.frame_skip

    assert physics() == physics(preset="small") == physics(preset="general") == ("fast", 4)
    assert physics(preset="small", file=file) == ("accurate", 1)
    assert physics(preset="small", values={"physics": "jax2d"}) == ("jax2d", 4)


def test_steps_that_are_no_whole_number_of_updates_are_told():
    values = {"num_train_envs": 8, "num_steps": 4, "num_minibatches": 2}
    config = make_config("ppo", values=values | {"total_timesteps": 100})
    told = "total_timesteps = 100 is no whole number of updates of 32: 96 are trained"
    assert config.rounded == told
    assert make_config("ppo", values=values | {"total_timesteps": 96}).rounded == ""
