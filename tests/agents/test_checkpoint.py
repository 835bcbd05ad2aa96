"""Saving and loading agents; every way in which a checkpoint can be bad gives one sentence."""

import dataclasses
import json
import os
import resource
import shutil
import time
from pathlib import Path

import jax
import numpy as np
import pytest
from safetensors.numpy import load_file, save_file

from kinetix.agents.agent import Agent, load_agent, save_agent
from kinetix.agents.arrays import flatten
from kinetix.agents.card import AgentCard, CapacityCard, ObservationCard
from kinetix.agents.from_card import init_parameters
from kinetix.agents.networks.config import NetworkConfig
from kinetix.agents.normalisation import start, to_card, update
from kinetix.errors import CheckpointError
from tests.agents.observations import random_entities
from tests.agents.tiny import NETWORK

CARD = AgentCard(
    name="Tiny",
    description="An agent for tests",
    network=NETWORK,
    capacity=CapacityCard(polygons=5, circles=2, joints=1, thrusters=1),
    training={"algorithm": "ppo", "seed": 3},
    results={"mean_solve_rate": 0.5},
)


@pytest.fixture(scope="module")
def agent():
    return Agent(CARD, init_parameters(CARD, jax.random.key(0)))


@pytest.fixture(scope="module")
def saved(agent, tmp_path_factory):
    directory = tmp_path_factory.mktemp("agents") / "tiny"
    save_agent(agent, directory)
    return directory


@pytest.fixture
def copy(saved, tmp_path):
    return shutil.copytree(saved, tmp_path / "agent")


def _same(a, b):
    a, b = dict(flatten(a)), dict(flatten(b))
    assert a.keys() == b.keys()
    for name, leaf in a.items():
        assert np.asarray(leaf).dtype == np.asarray(b[name]).dtype
        np.testing.assert_array_equal(leaf, b[name])


def _edit(directory, **changes):
    path = directory / "agent.json"
    content = json.loads(path.read_text())
    for place, value in changes.items():
        *parents, last = place.split("__")
        node = content
        for parent in parents:
            node = node[parent]
        node[last] = value
    path.write_text(json.dumps(content))


def test_there_and_back(agent, saved):
    loaded = load_agent(saved)
    assert loaded.card == agent.card
    _same(loaded.params["params"], agent.params["params"])
    assert not [path for path in saved.parent.iterdir() if path != saved]


def test_every_option_is_written_even_at_its_default(saved, tmp_path):
    save_agent(load_agent(saved), tmp_path / "again")
    content = json.loads((tmp_path / "again" / "agent.json").read_text())
    assert set(content["network"]) == {field.name for field in dataclasses.fields(NetworkConfig)}
    assert set(content["environment"]) == {
        "physics",
        "frame_skip",
        "dt",
        "dense_reward_scale",
        "parity",
    }


def test_saving_again_replaces(agent, copy):
    save_agent(Agent(CARD.replace(name="Second"), agent.params["params"]), copy)
    assert load_agent(copy).card.name == "Second"
    assert sorted(path.name for path in copy.parent.iterdir()) == ["agent"]


def test_there_and_back_through_the_published_form(agent, tmp_path):
    save_agent(agent, tmp_path / "peer", format="kinetix-env")
    assert sorted(p.name for p in (tmp_path / "peer").iterdir()) == [
        "config.json",
        "params.safetensors",
    ]
    loaded = load_agent(tmp_path / "peer")
    assert loaded.card == agent.card
    _same(loaded.params["params"], agent.params["params"])


def test_the_widths_of_flat_agents_are_found_from_their_tensors(tmp_path):
    capacity = CapacityCard(polygons=6, circles=3, joints=2, thrusters=2)
    for kind, form in (
        ("flat_mlp", "symbolic_flat"),
        ("permutation_invariant_mlp", "symbolic_flat_padded"),
    ):
        card = AgentCard(
            name="flat",
            network=NetworkConfig(kind=kind, actor_depth=1, critic_depth=1),
            observation=ObservationCard(type=form),
            capacity=capacity,
        )
        flat = Agent(card, init_parameters(card, jax.random.key(1)))
        save_agent(flat, tmp_path / form, format="kinetix-env")
        config = json.loads((tmp_path / form / "config.json").read_text())
        del config["capacity"]
        (tmp_path / form / "config.json").write_text(json.dumps(config))
        assert load_agent(tmp_path / form).card.capacity == capacity


def test_normalisation_travels_with_the_agent(agent, tmp_path):
    observation = jax.tree.map(lambda x: np.stack([x] * 3), random_entities(0))
    statistics = to_card(update(start(observation), observation))
    made = Agent(CARD.replace(normalisation=statistics), agent.params["params"])
    save_agent(made, tmp_path / "agent")
    assert load_agent(tmp_path / "agent").card.normalisation == statistics
    with pytest.raises(CheckpointError, match="cannot carry the normalisation"):
        save_agent(made, tmp_path / "peer", format="kinetix-env")


def test_options_of_observations_travel_with_the_agent(agent, tmp_path):
    seen = ObservationCard(type=CARD.observation.type, options={"symmetric_contacts": True})
    made = Agent(CARD.replace(observation=seen), agent.params["params"])
    save_agent(made, tmp_path / "agent")
    assert load_agent(tmp_path / "agent").card.observation == seen
    with pytest.raises(CheckpointError, match=r"cannot carry the options .*symmetric_contacts"):
        save_agent(made, tmp_path / "peer", format="kinetix-env")


def test_the_newest_checkpoint_of_a_run_is_taken(agent, tmp_path):
    for step in (9, 10):
        save_agent(
            Agent(CARD.replace(name=str(step)), agent.params["params"]),
            tmp_path / "checkpoints" / str(step),
        )
    (tmp_path / "checkpoints" / "11").mkdir()
    (tmp_path / "checkpoints" / ".12.34.tmp").mkdir()
    assert load_agent(tmp_path).card.name == f"{tmp_path.name}@10"
    seed = tmp_path / "lr=0.1" / "seed_0"
    seed.mkdir(parents=True)
    (tmp_path / "checkpoints").rename(seed / "checkpoints")
    assert load_agent(seed).card.name == "lr=0.1/seed_0@10"


def test_the_description_is_judged_before_any_array_is_read(copy):
    shutil.rmtree(copy / "params")

    def refuse(card):
        raise CheckpointError(f"{card.name} does not fit")

    with pytest.raises(CheckpointError, match="Tiny does not fit"):
        load_agent(copy, accept=refuse)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"format": "zip"}, r"agent\.json: \$\.format: expected 'kinetix-agent', got 'zip'"),
        ({"version": 2}, r"\$\.version: this program reads up to 1, the file has 2"),
        ({"version": "1"}, r"\$\.version: expected a whole number"),
        ({"colour": "red"}, "unknown field 'colour'"),
        ({"network__depth": 3}, r"\$\.network\.depth: unknown option"),
        ({"network__actor_dept": 3}, "did you mean 'actor_depth'"),
        (
            {"network__num_heads": "8"},
            r"\$\.network\.num_heads: expected a whole",
        ),
        ({"network__num_heads": 6}, "num_heads: expected a multiple of 4"),
        ({"network__actor_width": 10**8}, "actor_width: expected a whole number from 1 to 65536"),
        ({"network": 5}, r"\$\.network: expected an object"),
        ({"observation__type": "symbolic_flat"}, "reads symbolic_entity, got 'symbolic_flat'"),
        ({"action__type": "telepathy"}, "expected multi_discrete, discrete or continuous"),
        ({"network__transformer_encoder_size": 16}, "has the shape .*, expected"),
        ({"network__actor_depth": 2}, "tensor .* is missing"),
        ({"capacity__polygons": "many"}, "expected a whole number"),
    ],
)
def test_a_bad_description(copy, changes, sentence):
    _edit(copy, **changes)
    with pytest.raises(CheckpointError, match=sentence) as caught:
        load_agent(copy)
    assert "\n" not in str(caught.value)


def _truncate_card(directory):
    path = directory / "agent.json"
    path.write_bytes(path.read_bytes()[:200])


def _not_an_object(directory):
    (directory / "agent.json").write_text("[1, 2]")


def _no_arrays(directory):
    shutil.rmtree(directory / "params")


def _truncate_arrays(directory):
    for path in (directory / "params").rglob("*"):
        if path.is_file() and path.stat().st_size > 300:
            path.write_bytes(path.read_bytes()[:150])


def _garbage(directory):
    for path in (directory / "params").rglob("*"):
        if path.is_file():
            path.write_bytes(b"\x80\x04cposix\nsystem\n")


def _escape(directory):
    outside = directory.parent / "outside"
    (directory / "params").rename(outside)
    (directory / "params").symlink_to(outside)


def _other_parameters(directory):
    card = CARD
    other = Agent(card, init_parameters(card, jax.random.key(9)))
    save_agent(other, directory.parent / "other")
    shutil.rmtree(directory / "params")
    (directory.parent / "other" / "params").rename(directory / "params")


@pytest.mark.parametrize(
    ("damage", "sentence"),
    [
        (_truncate_card, "agent.json: not JSON"),
        (_not_an_object, "expected an object, got list"),
        (_no_arrays, "params: expected a directory of parameters"),
        (_truncate_arrays, "params: the arrays cannot be read"),
        (_garbage, "params: the arrays cannot be read"),
        (_escape, "leads out of the checkpoint"),
        (_other_parameters, "are not those that agent.json was written for"),
    ],
)
def test_a_damaged_directory(copy, damage, sentence):
    damage(copy)
    with pytest.raises(CheckpointError, match=sentence) as caught:
        load_agent(copy)
    assert "\n" not in str(caught.value)
    assert str(copy) in str(caught.value)


def test_a_limit_on_the_size_of_files_is_one_sentence(agent, tmp_path, capfd):
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4 * 1024, before[1]))
    try:
        with pytest.raises(CheckpointError) as caught:
            save_agent(agent, tmp_path / "agent")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert str(caught.value) == f"{tmp_path / 'agent'}: cannot be written: File too large"
    assert capfd.readouterr() == ("", "")
    assert not list(tmp_path.iterdir())


def test_a_truncated_array_prints_nothing_but_the_sentence(copy, capfd):
    _truncate_arrays(copy)
    for _ in range(5):
        with pytest.raises(CheckpointError):
            load_agent(copy)
    assert "Traceback" not in capfd.readouterr().err


def _said(*path, value):
    def damage(directory):
        content = json.loads((directory / "agent.json").read_text())
        part = content
        for key in path[:-1]:
            part = part[key]
        part[path[-1]] = value
        (directory / "agent.json").write_text(json.dumps(content))

    return damage


def _pipe(directory):
    (directory / "params" / "manifest.ocdbt").unlink(missing_ok=True)
    os.mkfifo(directory / "params" / "manifest.ocdbt")


def _loop(directory):
    (directory / "params" / "loop").symlink_to("loop")


_STATISTICS = {"count": 1.0, "mean": {"": [0.0]}, "variance": {"": [1.0]}}


@pytest.mark.parametrize(
    ("damage", "sentence"),
    [
        (_said("capacity", "polygons", value=10**9), "1024"),
        (_said("capacity", "motor_bindings", value=10**9), "64"),
        (_said("environment", "frame_skip", value=0), ">= 1"),
        (_said("environment", "frame_skip", value=10**9), "<= 1000"),
        (_said("environment", "dt", value=0.0), "dt"),
        (_said("environment", "dt", value=-1), "dt"),
        (_said("environment", "physics", value="magic"), "unknown physics 'magic'"),
        (_said("environment", "parity", value="x"), "parity: expected"),
        (_said("environment", value=[]), "expected an object, got an array"),
        (_said("observation", "options", value={"layout": True}), "no network can be made"),
        (_said("observation", "options", value={"x": True}), "no network can be made"),
        (_said("observation", "type", value="x"), "observation"),
        (_said("action", "type", value="x"), "action type"),
        (_said("network", "num_heads", value=[]), "num_heads"),
        (_said("network", value=3), "expected an object"),
        (_said("normalisation", value=_STATISTICS), r"normalisation\.mean: expected columns"),
        (_said("name", value={}), "name"),
        (_said("parameters", value={"a": "b"}), "parameters"),
        (_pipe, "got a device, pipe or socket"),
        (_loop, "cannot be read"),
    ],
)
def test_an_agent_that_asks_for_what_cannot_be(copy, damage, sentence):
    damage(copy)
    began = time.monotonic()
    with pytest.raises(CheckpointError, match=sentence) as caught:
        load_agent(copy)
    assert "\n" not in str(caught.value)
    assert time.monotonic() - began < 10


def test_what_is_no_agent(tmp_path):
    with pytest.raises(CheckpointError, match="there is no such directory"):
        load_agent(tmp_path / "nowhere")
    with pytest.raises(CheckpointError, match=r"expected an agent: agent\.json"):
        load_agent(tmp_path)
    (tmp_path / "checkpoints").mkdir()
    with pytest.raises(CheckpointError, match="no complete checkpoint yet"):
        load_agent(tmp_path)


def test_of_the_folder_of_a_sweep_or_of_seeds_a_run_is_to_be_named(tmp_path):
    run = tmp_path / "seeds" / "seed_0"
    (run / "checkpoints" / "64").mkdir(parents=True)
    for folder in (tmp_path / "seeds", tmp_path):
        with pytest.raises(CheckpointError) as caught:
            load_agent(folder)
        said = f"{folder}: is a folder of runs; name one of them, such as {run}"
        assert str(caught.value) == said


def test_nothing_else_is_overwritten(agent, tmp_path):
    (tmp_path / "letter.txt").write_text("mine")
    with pytest.raises(CheckpointError, match="is not empty and holds no agent"):
        save_agent(agent, tmp_path)
    assert (tmp_path / "letter.txt").read_text() == "mine"


def test_the_current_folder_is_not_replaced(agent, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(CheckpointError, match=r"^\.: .*name a folder inside it"):
        save_agent(agent, ".")
    assert list(tmp_path.iterdir()) == []


@pytest.fixture
def foreign(agent, tmp_path):
    save_agent(agent, tmp_path / "peer", format="kinetix-env")
    return tmp_path / "peer"


def _drop_tensor(path):
    tensors = load_file(path)
    del tensors["params/Dense_1/bias"]
    save_file(tensors, path)


def _reshape_tensor(path):
    tensors = load_file(path)
    tensors["params/Dense_1/bias"] = np.zeros(3, np.float32)
    save_file(tensors, path)


def _half_precision(path):
    tensors = load_file(path)
    tensors["params/Dense_1/bias"] = tensors["params/Dense_1/bias"].astype(np.float16)
    save_file(tensors, path)


def _add_tensor(path):
    save_file(load_file(path) | {"params/Dense_9/bias": np.zeros(3, np.float32)}, path)


def _truncate(path):
    path.write_bytes(path.read_bytes()[:500])


@pytest.mark.parametrize(
    ("damage", "sentence"),
    [
        (_drop_tensor, "params.safetensors: tensor 'params/Dense_1/bias' is missing"),
        (_reshape_tensor, r"tensor 'params/Dense_1/bias' has the shape \(3,\), expected \(7,\)"),
        (_half_precision, "tensor 'params/Dense_1/bias' is float16, expected float32"),
        (_add_tensor, "tensor 'params/Dense_9/bias' is unknown"),
        (_truncate, "params.safetensors: not a readable safetensors file"),
    ],
)
def test_a_damaged_file_of_tensors(foreign, damage, sentence):
    damage(foreign / "params.safetensors")
    with pytest.raises(CheckpointError, match=sentence):
        load_agent(foreign)


def test_unknown_options_of_published_agents_are_ignored(foreign):
    path = foreign / "config.json"
    config = json.loads(path.read_text())
    config["model"] |= {"something_new": 1, "override_model_depth": 1}
    path.write_text(json.dumps(config | {"more": [1, 2]}))
    assert load_agent(foreign).card.network == NETWORK


def test_the_form_of_kinetix_env_is_replaced_whole_or_not_at_all(agent, tmp_path, monkeypatch):
    folder = tmp_path / "peer"
    save_agent(agent, folder, format="kinetix-env")
    (folder / "README.md").write_text("mine")
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    other = Agent(agent.card.replace(description="newer"), agent.params["params"])
    write = Path.write_text

    def dies(path, *arguments, **named):
        write(path, "", encoding="utf-8")
        raise KeyboardInterrupt

    with monkeypatch.context() as patched, pytest.raises(KeyboardInterrupt):
        patched.setattr(Path, "write_text", dies)
        save_agent(other, folder, format="kinetix-env")
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before
    save_agent(other, folder, format="kinetix-env")
    assert load_agent(folder).card.description == "newer"
    assert (folder / "README.md").read_text() == "mine"
    assert [path.name for path in tmp_path.iterdir()] == ["peer"]


def test_the_form_of_kinetix_env_can_be_saved_where_one_stands(agent, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "notes.txt").write_text("mine")
    save_agent(agent, ".", format="kinetix-env")
    assert load_agent(".").card == agent.card
    assert Path.cwd() == tmp_path and (tmp_path / "notes.txt").read_text() == "mine"
