"""Functions of another form do what they do in kinetix-env."""

import json

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix import EnvParams, load_from_json_file, make_kinetix_env, static_env_params_from_size
from kinetix.environment.generators.locomotion import LocomotionParams
from kinetix.environment.reset import level_state
from kinetix.environment.spaces import ActionType, ObservationType
from kinetix.errors import CheckpointError, KinetixError

KEY = jax.random.PRNGKey(0)
LEVEL = "s/goalkeeper"
HYDRA = {
    "env": {"action_type": "multi_discrete", "observation_type": "symbolic_entity"},
    "env_size": {"env_size_name": "s", "env_size_type": "predefined", "num_polygons": 5}
    | {"num_circles": 2, "num_joints": 1, "num_thrusters": 1},
    "learning": {"num_steps": 8, "num_train_envs": 4, "total_timesteps": 320, "num_minibatches": 2},
    "model": {"fc_layer_depth": 1, "fc_layer_width": 16, "recurrent_model": True},
    "misc": {"seed": 3, "use_wandb": False},
    "train_levels": {"train_level_mode": "list", "train_levels_list": [LEVEL]},
    "frame_skip": 2,
    "dense_reward_scale": 0.2,
}


@pytest.fixture(scope="module")
def static():
    return static_env_params_from_size("s", physics="jax2d")


@pytest.fixture(scope="module")
def state(static):
    return level_state(LEVEL, static)


def test_a_hydra_configuration_becomes_an_environment_and_a_network():
    from kinetix.environment.ued.ued import make_reset_fn_from_config
    from kinetix.models import ScannedRNN, make_network_from_config
    from kinetix.util.config import generate_params_from_config, normalise_config

    before = json.dumps(HYDRA)
    config = normalise_config(HYDRA, "test")
    assert json.dumps(HYDRA) == before
    assert config["action_type"] is ActionType.MULTI_DISCRETE
    assert config["observation_type"] is ObservationType.SYMBOLIC_ENTITY
    assert (config["num_updates"], config["minibatch_size"]) == (10, 16)
    env_params, static = generate_params_from_config(config)
    assert env_params.dense_reward_scale == 0.2
    assert static.capacity == static_env_params_from_size("s").capacity
    assert static.frame_skip == 2
    reset_fn = make_reset_fn_from_config(config, env_params, static)
    env = make_kinetix_env(
        config["action_type"], config["observation_type"], reset_fn, env_params, static
    )
    obs, _ = env.reset(KEY, env_params)
    network = make_network_from_config(env, env_params, config)
    inputs = jax.tree.map(lambda x: x[None, None], (obs, jnp.zeros((), bool)))
    hidden = ScannedRNN.initialize_carry(1)
    params = network.init(KEY, hidden, inputs)
    assert "ScannedRNN_0" in params["params"]["GeneralActorCriticRNN_0"]
    after, policy, value = network.apply(params, hidden, inputs)
    action = policy.sample(seed=KEY)
    assert action.shape == (1, 1, 6)
    assert value.shape == (1, 1)
    np.testing.assert_allclose(
        policy.log_prob_disentangled(action).sum(-1), policy.log_prob(action), rtol=1e-5
    )
    np.testing.assert_allclose(policy.entropy_disentangled().sum(-1), policy.entropy(), rtol=1e-5)
    # One array of memory stays one array, so that it can be carried by a scan.
    single, _, _ = network.apply(params, hidden[0], inputs)
    np.testing.assert_array_equal(single, after[0])


def test_unknown_words_of_a_configuration_are_named():
    from kinetix.environment.ued.ued import make_reset_fn_from_config
    from kinetix.util.config import generate_params_from_config, normalise_config

    with pytest.raises(KinetixError, match="'xl': expected one of s, m, l"):
        generate_params_from_config({"env_size_name": "xl"})
    with pytest.raises(KinetixError, match="'sometimes': expected random"):
        make_reset_fn_from_config(
            {"train_level_mode": "sometimes"}, EnvParams(), static_env_params_from_size("s")
        )
    with pytest.raises(KinetixError, match="'both': expected one of discrete"):
        normalise_config({"action_type": "both"}, "test")


def test_levels_are_grouped_as_evaluations_group_them():
    from kinetix.util.config import get_eval_level_groups

    levels = ["s/h0_weak_thrust", "l/mjc_walker", "s/h1_thrust_over_ball"]
    assert get_eval_level_groups(levels) == [
        ("s_all", [levels[0], levels[2]]),
        ("s_handmade", [levels[0], levels[2]]),
        ("l_all", [levels[1]]),
        ("l_mjc", [levels[1]]),
    ]


def test_options_of_walkers_go_by_the_names_of_kinetix_env():
    from kinetix.compat.ued import _locomotion

    assert _locomotion(
        {
            "body_dimension_default": [0.5, 0.3],
            "leg_dimension_sampling_range_ratio": 0.2,
            "ankle_dimension_sampling_range_ratio_exclude": 0.1,
            "density_absolute_range": 0.4,
            "friction_absolute_range_exclude": 0.3,
            "add_ankles": False,
        }
    ) == LocomotionParams(
        body_dim_default=(0.5, 0.3),
        leg_dim_sampling_ratio=0.2,
        ankle_dim_exclude=0.1,
        density_range=0.4,
        friction_exclude=0.3,
        add_ankles=False,
    )


def test_mutations_make_what_they_are_forced_to():
    from kinetix.environment.ued.mutators import mutate_add_connected_shape, mutate_add_shape

    from kinetix.environment import UEDParams, create_empty_env

    static = static_env_params_from_size("m")
    ued = UEDParams(fixate_chance_min=1.0, min_rjoints_bias=0)
    rest = (EnvParams(), static, ued)

    def grown(key, forced):
        state = mutate_add_shape(key, create_empty_env(static), *rest, forced)
        return state, mutate_add_connected_shape(key, state, *rest, forced)

    for forced in (False, True):
        keys = jax.random.split(KEY, 8)
        one, two = jax.jit(jax.vmap(grown, in_axes=(0, None)), static_argnums=1)(keys, forced)
        fixed = np.asarray(one.world.bodies.active & (one.world.bodies.inverse_mass == 0))
        assert ((fixed.sum(axis=1) == 4) == forced).all()
        assert two.world.joints.active.any()
        assert two.world.joints.fixed.any() != forced
    with pytest.raises(TypeError, match="force_no_fix"):
        mutate_add_shape(KEY, one, force_no_fix=False)


def test_fields_of_a_state_have_the_names_of_kinetix_env(state):
    stacked = jax.tree.map(lambda x: jnp.stack([x, x]), state)
    assert state.polygon.position.shape == (5, 2)
    assert state.circle.radius.shape == (2,)
    np.testing.assert_array_equal(stacked.circle.position[1], state.circle.position)
    np.testing.assert_array_equal(
        np.concatenate([state.polygon.position, state.circle.position]), state.bodies.position
    )
    np.testing.assert_array_equal(
        np.concatenate([state.polygon_shape_roles, state.circle_shape_roles]), state.labels.role
    )
    assert stacked.polygon_densities.shape == (2, 5)
    assert not stacked.circle_highlighted.any()
    assert state.motor_bindings.shape == state.motor_auto.shape == (1,)
    np.testing.assert_allclose(state.gravity, (0, -9.81), rtol=1e-6)
    a = int(state.joint.a_index[0])
    anchor = state.bodies.position[a] + np.linalg.norm(state.joint.a_relative_pos[0])
    assert np.linalg.norm(state.joint.global_position[0] - state.bodies.position[a]) == (
        pytest.approx(np.linalg.norm(state.joint.a_relative_pos[0]), abs=1e-5)
    )
    assert anchor.shape == (2,)
    assert stacked.joint.global_position.shape == (2, 1, 2)


@pytest.mark.parametrize("batched", [False, True])
def test_a_state_is_changed_by_the_names_of_kinetix_env(state, batched):
    from kinetix.environment.kinetix_env.rewrite import NAMES

    if batched:
        state = jax.tree.map(lambda x: jnp.stack([x, x]), state)
    same = state.replace(**{name: getattr(state, name) for name in NAMES})
    jax.tree.map(np.testing.assert_array_equal, same, state)

    changed = jax.jit(
        lambda state: state.replace(
            polygon=state.polygon.replace(friction=state.polygon.friction + 1),
            circle=state.circle.replace(velocity=state.circle.velocity + 2),
            joint=state.joint.replace(active=jnp.zeros_like(state.joint.active)),
            thruster=state.thruster.replace(power=state.thruster.power * 3),
            gravity=state.gravity * 0,
            motor_auto=~state.motor_auto,
            circle_shape_roles=state.circle_shape_roles + 1,
        )
    )(state)
    np.testing.assert_array_equal(changed.polygon.friction, state.polygon.friction + 1)
    np.testing.assert_array_equal(changed.circle.friction, state.circle.friction)
    np.testing.assert_array_equal(changed.circle.velocity, state.circle.velocity + 2)
    np.testing.assert_array_equal(changed.polygon.position, state.polygon.position)
    np.testing.assert_array_equal(changed.thruster.power, state.thruster.power * 3)
    np.testing.assert_array_equal(changed.circle_shape_roles, state.circle_shape_roles + 1)
    np.testing.assert_array_equal(changed.polygon_shape_roles, state.polygon_shape_roles)
    assert not changed.gravity.any() and (changed.motor_auto != state.motor_auto).all()
    # Bodies that no joint holds together any more collide.
    pair = (..., state.joint.a_index.ravel()[0], state.joint.b_index.ravel()[0])
    assert not np.asarray(state.collision_matrix)[pair].any()
    assert np.asarray(changed.collision_matrix)[pair].all()


def test_new_values_of_a_state_take_the_types_of_the_old(state):
    changed = state.replace(
        gravity=(0, -5), motor_auto=[1], circle=state.circle.replace(radius=np.ones(2))
    )
    np.testing.assert_array_equal(changed.gravity, (0, -5))
    assert changed.motor_auto.all()
    for new, old in zip(jax.tree.leaves(changed), jax.tree.leaves(state), strict=True):
        assert (new.shape, new.dtype) == (old.shape, old.dtype)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda state: {"gravitiy": 0}, "no field 'gravitiy': did you mean 'gravity'"),
        (lambda state: {"gravity": -5}, r"gravity: expected the shape \(2,\), got \(\)"),
        (lambda state: {"polygon": state.circle}, r"polygon.position: .* \(5, 2\), got \(2, 2\)"),
        (lambda state: {"joint": state.circle}, "joint: expected JointFields .*got RigidBodies"),
    ],
    ids=["name", "number", "circles", "kind"],
)
def test_a_change_that_does_not_fit_a_state_is_told(state, change, told):
    with pytest.raises(KinetixError, match=told):
        state.replace(**change(state))


def test_parameters_go_by_the_names_of_kinetix_env(state, static):
    from kinetix.render.renderer_pixels import make_render_pixels, make_render_pixels_rl

    from kinetix import permute_state, sample_kinetix_level

    load_from_json_file(filename=LEVEL)
    for make in (make_render_pixels, make_render_pixels_rl):
        make(env_params=EnvParams(), static_params=static)
    permuted = permute_state(rng=KEY, env_state=state, static_env_params=static)
    same = permute_state(key=KEY, state=state)
    jax.tree.map(np.testing.assert_array_equal, permuted, same)
    draw = jax.eval_shape(
        lambda key: sample_kinetix_level(
            rng=key, engine=None, env_params=EnvParams(), static_env_params=static
        ),
        KEY,
    )
    assert jax.tree.map(jnp.shape, draw) == jax.tree.map(jnp.shape, state)
    with pytest.raises(TypeError, match="permute_state: rng and key are the same"):
        permute_state(rng=KEY, key=KEY, state=state)


def test_levels_of_all_sizes_are_stacked(tmp_path):
    from kinetix.util.saving import export_env_state_to_json, load_evaluation_levels

    levels, static = load_evaluation_levels([LEVEL, "m/leapfrog"])
    assert static.capacity == static_env_params_from_size("m").capacity
    assert levels.timestep.shape == (2,)
    one = jax.tree.map(lambda x: x[1], levels)
    export_env_state_to_json(tmp_path / "back", one, static, EnvParams())
    again, _, _ = load_from_json_file(tmp_path / "back.json")
    np.testing.assert_allclose(again.bodies.position, one.bodies.position, atol=1e-6)
    np.testing.assert_array_equal(again.labels.role, one.labels.role)
    with pytest.raises(KinetixError, match="at least one level"):
        load_evaluation_levels([])


def test_parameters_are_kept_without_pickles(tmp_path):
    from kinetix.util.saving import load_params, save_params

    tree = {"params": {"Dense_0": {"kernel": np.ones((2, 3), np.float32)}}}
    save_params(tree, tmp_path / "params.safetensors")
    np.testing.assert_array_equal(
        load_params(tmp_path / "params.safetensors")["params"]["Dense_0"]["kernel"],
        tree["params"]["Dense_0"]["kernel"],
    )
    (tmp_path / "full_model.pbz2").write_bytes(b"BZh9")
    with pytest.raises(CheckpointError, match="pickles are not read"):
        load_params(tmp_path / "full_model.pbz2")


def test_statistics_agree_with_numpy():
    from kinetix.util.learning import rms_init, rms_normalise, rms_update

    batch = np.random.default_rng(0).normal(2, 3, (200, 4)).astype(np.float32)
    statistics = rms_init({"x": batch[0], "mask": np.ones(2, bool)})
    for part in np.split(batch, 4):
        seen = {"x": part.reshape(5, 10, 4), "mask": np.ones((5, 10, 2), bool)}
        statistics = rms_update(statistics, seen)
    np.testing.assert_allclose(statistics["x"].mean, batch.mean(0), rtol=1e-3)
    np.testing.assert_allclose(statistics["x"].var, batch.var(0), rtol=1e-3)
    done = rms_normalise(statistics, {"x": batch, "mask": np.ones(2, bool)})
    np.testing.assert_allclose(done["x"].std(0), 1, rtol=1e-3)
    assert done["mask"].dtype == bool


def test_which_actions_matter(state, static):
    from kinetix.data import get_valid_action_mask

    mask = get_valid_action_mask(jax.tree.map(lambda x: x[None], state), static)
    assert mask.shape == (1, 6)
    assert 0 < int(mask.sum()) < 6


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*before 2.0:FutureWarning")
def test_wrappers_of_old_projects_build_on_each_other(state, static):
    from kinetix.environment.env import make_kinetix_env_from_name
    from kinetix.environment.wrappers import (
        AutoReplayWrapper,
        GymnaxWrapper,
        LogWrapper,
        UnderspecifiedEnvWrapper,
    )

    class Noisy(UnderspecifiedEnvWrapper):
        def step_env(self, key, state, action, params):
            return self._env.step_env(key, state, action + 0.1, params)

    class Batch(GymnaxWrapper):
        def reset_to_level(self, rng, level, params):
            keys = jax.random.split(rng, 3)
            return jax.vmap(self._env.reset_to_level, in_axes=(0, None, None))(keys, level, params)

        def step(self, rng, state, action, params):
            keys = jax.random.split(rng, 3)
            return jax.vmap(self._env.step, in_axes=(0, 0, 0, None))(keys, state, action, params)

    params = EnvParams()
    env = make_kinetix_env_from_name("Kinetix-Symbolic-Continuous-v1", static_env_params=static)
    env = Batch(LogWrapper(AutoReplayWrapper(Noisy(env))))
    short = state.replace(labels=state.labels.replace(max_timesteps=jnp.int32(2)))
    obs, first = env.reset_to_level(KEY, short, params)
    assert obs.shape == (3, 140)
    step = jax.jit(env.step)
    action = jnp.zeros((3, 6))
    _, after, _, done, _ = step(KEY, first, action, params)
    assert not done.any()
    again, after, _, done, info = step(KEY, after, action, params)
    assert done.all() and info["returned_episode"].all()
    np.testing.assert_array_equal(again, obs)
    assert (after.episode_lengths == 0).all()


@pytest.mark.slow
def test_an_evaluation_plays_every_level_once(state, static):
    from flax.training.train_state import TrainState
    from kinetix.models import make_network_from_config
    from kinetix.util import general_eval, no_op_and_random_rollout
    from optax import sgd

    params = EnvParams()
    env = make_kinetix_env("multi_discrete", "symbolic_flat", None, params, static, False)
    network = make_network_from_config(env, params, {"actor_depth": 1, "critic_depth": 1})
    levels = jax.tree.map(lambda x: jnp.stack([x, x]), state)
    obs, states = jax.vmap(env.reset, in_axes=(0, None, 0))(
        jax.random.split(KEY, 2), params, levels
    )
    inputs = (obs[None], jnp.zeros((1, 2), bool))
    train_state = TrainState.create(
        apply_fn=network.apply,
        params=network.init(KEY, network.initialize_carry(2), inputs),
        tx=sgd(0.1),
    )
    played = general_eval(KEY, env, params, train_state, levels, 12, 2)
    assert played.rewards.shape == (12, 2)
    assert played.states.timestep.shape == (12, 2)
    assert (played.episode_lengths == 12).all()
    assert played.infos["GoalR"].shape == (12, 2)
    results = no_op_and_random_rollout(env, params, KEY, obs, states, 2, 4)
    assert len(results) == 6
    assert (results[1] == 4).all()


@pytest.mark.slow
def test_levels_are_evaluated_as_the_published_example_does(state, static):
    from flax.training.train_state import TrainState
    from kinetix.models import make_network_from_config
    from kinetix.util import EvalSpec, make_eval_fn
    from optax import identity

    params = EnvParams().replace(max_timesteps=6)
    short = state.replace(labels=state.labels.replace(max_timesteps=jnp.int32(0)))
    env = make_kinetix_env("multi_discrete", "symbolic_flat", None, params, static, False)
    network = make_network_from_config(env, params, {"actor_depth": 1, "critic_depth": 1})
    levels = jax.tree.map(lambda x: jnp.stack([x, x]), short)
    obs, _ = jax.vmap(env.reset, in_axes=(0, None, 0))(jax.random.split(KEY, 2), params, levels)
    inputs = (obs[None], jnp.zeros((1, 2), bool))
    train_state = TrainState.create(
        apply_fn=network.apply,
        params=network.init(KEY, network.initialize_carry(2), inputs),
        tx=identity(),
    )
    specs = {
        "plain": EvalSpec(levels, 2, ["a", "b"], plot_videos=False),
        "filmed": EvalSpec(levels, 2, ["a", "b"], plot_videos=True, num_envs_to_video=1),
    }
    found = make_eval_fn(env, params, 3)(KEY, train_state, specs)
    assert found["plain"].render_metrics is None
    np.testing.assert_array_equal(found["plain"].episode_metrics.episode_lengths, [6, 6])
    assert found["plain"].episode_metrics.episode_solve_rates.shape == (2,)
    film = found["filmed"].render_metrics
    assert film is not None
    assert film.states_to_plot.timestep.shape == (6, 1)
    np.testing.assert_array_equal(film.original_level_list_index, [0])


class _Weights:
    """A train state as far as these functions look at it."""

    def __init__(self, params):
        self.params = params

    def replace(self, *, params):
        return _Weights(params)


def test_parameters_go_to_a_folder_and_come_back(tmp_path, monkeypatch):
    from kinetix.util import load_train_state_from_wandb_artifact_path, save_model
    from kinetix.util.saving import load_params_from_wandb_artifact_path

    monkeypatch.chdir(tmp_path)
    tree = {"params": {"Dense_0": {"kernel": np.ones((2, 3), np.float32)}}}
    empty = {"params": {"Dense_0": {"kernel": np.zeros((2, 3), np.float32)}}}
    folder = save_model(_Weights(tree), 64, {"run_name": "mine"}, extra={"seed": 3})
    assert folder.as_posix() == "checkpoints/mine/64"
    state, extra = load_train_state_from_wandb_artifact_path(
        _Weights(empty), str(folder), return_extra=True
    )
    np.testing.assert_array_equal(state.params["params"]["Dense_0"]["kernel"], np.ones((2, 3)))
    assert extra == {"seed": 3}
    assert load_params_from_wandb_artifact_path(str(folder)).keys() == {"params"}
    other = {"params": {"Dense_0": {"kernel": np.zeros((4, 3), np.float32)}}}
    with pytest.raises(CheckpointError, match="not those of this network"):
        load_train_state_from_wandb_artifact_path(_Weights(other), str(folder))
    (tmp_path / "old").mkdir()
    (tmp_path / "old" / "full_model.pbz2").write_bytes(b"BZh9")
    with pytest.raises(CheckpointError, match=r"found 0 \(pickles are not read\)"):
        load_params_from_wandb_artifact_path("old")


def test_runs_and_artefacts_of_wandb_need_the_package(monkeypatch):
    import sys

    from kinetix.util import init_wandb
    from kinetix.util.saving import load_params_from_wandb_artifact_path

    monkeypatch.setitem(sys.modules, "wandb", None)
    with pytest.raises(KinetixError, match=r"pip install 'kinetix-editor\[wandb\]'"):
        load_params_from_wandb_artifact_path("team/project/model:latest")
    with pytest.raises(KinetixError, match="package wandb is missing"):
        init_wandb({"wandb_project": "mine"}, "PPO")


def test_an_environment_tells_its_kinds_with_what_they_can_do(static, state):
    env = make_kinetix_env(ActionType.CONTINUOUS, "symbolic_flat", None, EnvParams(), static)
    assert env.action_type == ActionType.CONTINUOUS == env.action_type
    assert env.action_type != ActionType.DISCRETE
    assert env.observation_type == ObservationType.SYMBOLIC_FLAT != env.action_type
    assert {ActionType.CONTINUOUS: 1}[ActionType("continuous")] == 1
    np.testing.assert_array_equal(env.action_type.noop_action(), np.zeros(6))
    assert env.action_space().contains(env.action_type.random_action(KEY))
    same = make_kinetix_env(env.action_type, env.observation_type, None, EnvParams(), static)
    assert same == env


def test_kinds_are_made_and_used_as_in_kinetix_env(static, state):
    from kinetix.environment.utils import convert_multi_discrete_actions

    from kinetix.environment.spaces import (
        ContinuousActions,
        EntityObservations,
        KinetixObservation,
        MultiDiscreteActions,
        SymbolicObservations,
    )

    params = EnvParams()
    env = make_kinetix_env("multi_discrete", "symbolic_flat", None, params, static)
    assert isinstance(env.action_type, MultiDiscreteActions)
    assert not isinstance(env.action_type, ContinuousActions)
    assert isinstance(env.observation_type, SymbolicObservations)
    assert not isinstance(env.observation_type, EntityObservations)
    assert not isinstance(env.action_type, type("Own", (MultiDiscreteActions,), {}))
    action = jnp.array([1, 2, 0, 0, 1, 0])
    np.testing.assert_array_equal(
        MultiDiscreteActions(params, static).process_action(action, state, static),
        convert_multi_discrete_actions(action, state, static, params),
    )
    np.testing.assert_array_equal(
        env.action_type.process_action(action, state, static),
        convert_multi_discrete_actions(action, state, static, params),
    )
    for kind in (env.observation_type, EntityObservations(params, static)):
        assert isinstance(kind, KinetixObservation)
        assert kind.observation_space(params) == kind.space
        assert kind.observation_space().contains(kind.get_obs(state))
        assert kind.hash_key() == hash(kind)


def test_an_environment_takes_kinds_as_classes_and_as_objects_with_options(static):
    from kinetix.environment import EntityObservations, MultiDiscreteActions, SymbolicObservations

    params = EnvParams()
    usual = make_kinetix_env("multi_discrete", "symbolic_entity", None, params, static)
    for action, seen in (
        (MultiDiscreteActions, EntityObservations),
        (MultiDiscreteActions(), EntityObservations(js_anchor_order=True)),
        (
            MultiDiscreteActions(params, static),
            EntityObservations(params, static, js_anchor_order=True),
        ),
    ):
        env = make_kinetix_env(action, seen, None, params, static)
        assert env.action_space() == usual.action_space()
        assert env.observation_space() == usual.observation_space()
        assert env.observation_type.js_anchor_order == (not isinstance(seen, type))
    assert SymbolicObservations(params, static).layout == usual.observation_type.layout


def test_an_episode_starts_again_in_a_state_of_the_log(static, state):
    from kinetix.environment import LogWrapper

    env = LogWrapper(make_kinetix_env("discrete", "blind", None, EnvParams(), static))
    _, logged = env.reset(KEY, EnvParams(), state)
    _, again = env.reset(KEY, EnvParams(), logged)
    np.testing.assert_array_equal(again.env_state.bodies.position, state.bodies.position)
    stepped = jax.eval_shape(env.step, KEY, logged, jnp.zeros((), int), EnvParams(), logged)
    assert jax.tree.structure(stepped[1]) == jax.tree.structure(logged)


def test_observations_and_steps_take_the_states_of_the_log(static, state):
    from kinetix.environment import LogWrapper

    env = LogWrapper(make_kinetix_env("discrete", "symbolic_flat", None, EnvParams(), static))
    obs, logged = jax.eval_shape(env.reset, KEY, EnvParams(), state)
    assert jax.eval_shape(env.get_obs, logged).shape == obs.shape
    assert jax.eval_shape(env.get_obs, state).shape == obs.shape
    _, after, _, _, info = jax.eval_shape(env.step_env, KEY, logged, jnp.zeros((), int))
    assert jax.tree.structure(after) == jax.tree.structure(logged)
    assert "returned_episode" in info


@pytest.mark.filterwarnings("ignore:.*before 2.0:FutureWarning")
@pytest.mark.parametrize("logged", [False, True], ids=["alone", "around a log"])
def test_a_level_is_played_again_after_a_reset_to_it(static, state, logged):
    from kinetix.environment.wrappers import AutoReplayWrapper, LogWrapper

    env = make_kinetix_env("discrete", "symbolic_flat", None, EnvParams(), static)
    env = AutoReplayWrapper(LogWrapper(env) if logged else env)
    obs, first = jax.eval_shape(env.reset, KEY, EnvParams(), state)
    assert jax.eval_shape(env.get_obs, first).shape == obs.shape
    _, after, *_ = jax.eval_shape(env.step, KEY, first, jnp.zeros((), int), EnvParams())
    assert jax.tree.map(jnp.shape, after) == jax.tree.map(jnp.shape, first)


def test_a_batch_of_levels_is_as_good_as_a_list_of_them(static, state):
    from kinetix.environment import make_reset_fn_list_of_levels

    stacked = jax.tree.map(lambda x: jnp.stack([x, x, x]), state)
    many = make_reset_fn_list_of_levels([state, stacked], static)
    assert repr(many) == "<reset function: one of 4 levels>"
    assert many == make_reset_fn_list_of_levels([state] * 4, static)


def test_masses_follow_by_either_rule(static, state):
    from kinetix.util.saving import check_if_mass_and_inertia_are_correct

    assert check_if_mass_and_inertia_are_correct(state, EnvParams(), static)
    heavy = state.replace(circle=state.circle.replace(inverse_mass=state.circle.inverse_mass * 0.5))
    assert not check_if_mass_and_inertia_are_correct(heavy, EnvParams(), static)
