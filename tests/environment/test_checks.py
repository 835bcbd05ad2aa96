"""Wrong arguments of `reset` and `step` get one sentence with what to do."""

import dataclasses
import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import kinetix
from kinetix import (
    EnvParams,
    LogWrapper,
    StaticEnvParams,
    UEDParams,
    forks,
    load_from_json_file,
    make_kinetix_env,
    make_render_pixels,
    make_reset_fn_list_of_levels,
    make_reset_fn_sample_kinetix_level,
    permute_state,
    sample_kinetix_level,
    static_env_params_from_size,
    vectorize,
)
from kinetix.agents.agent import Agent
from kinetix.engine.presets import solver_named
from kinetix.environment.actions.checks import with_usual_action
from kinetix.environment.params import physics_engine, static_env_params_of
from kinetix.environment.rearrange import expand_state
from kinetix.environment.reset import level_state, make_reset_fn_sample_sizes
from kinetix.environment.state import stack_states
from kinetix.errors import KinetixError
from kinetix.level.codec import load_level
from kinetix.level.sizes import SIZES
from kinetix.paths import levels_dir
from tests.environment.conftest import small_level

KEY = jax.random.key(0)
ACTION = jnp.zeros(6, jnp.int32)


def sentence(env, *arguments):
    with pytest.raises(KinetixError) as error:
        env.step(*arguments)
    return str(error.value)


def test_actions(small_env, small_state):
    step = (KEY, small_state)
    assert sentence(small_env, *step, ACTION[:5]) == (
        "action of shape (5,): expected (6,) (multi_discrete); see env.action_space()"
    )
    assert "for a batch use jax.vmap(env.step)" in sentence(small_env, *step, ACTION[None])
    assert "expected integers (multi_discrete)" in sentence(small_env, *step, ACTION * 1.0)


def test_arguments_in_another_order(small_env, small_state):
    assert "state: expected an EnvState, got an array of shape (6,)" in sentence(
        small_env, KEY, ACTION, small_state
    )
    assert "env_params: expected EnvParams, got StaticEnvParams" in sentence(
        small_env, KEY, small_state, ACTION, StaticEnvParams()
    )
    with pytest.raises(KinetixError, match=r"got EnvState; the order is .*reset\(key, env_params"):
        small_env.reset(KEY, small_state, EnvParams())


def test_a_level_where_only_one_argument_can_be_passed(small_env, small_state):
    """Wrappers such as Stoa's pass whatever they get in the place of the parameters."""
    _, state = small_env.reset(KEY, small_state)
    _, same = small_env.reset(KEY, None, small_state)
    jax.tree.map(np.testing.assert_array_equal, state, same)


def test_states_of_something_else(small_env, small_state):
    batch = jax.tree.map(lambda x: jnp.asarray(x)[None], small_state)
    assert "got a batch of shape (1,): use jax.vmap(env.step" in sentence(
        small_env, KEY, batch, ACTION
    )
    larger = level_state(small_level(), static_env_params_from_size("m", physics="drift"))
    assert "s (polygons, circles, joints, thrusters), got m: " in sentence(
        small_env, KEY, larger, ACTION
    )
    other = level_state(small_level(), static_env_params_from_size("s", physics="jax2d"))
    assert "another physics than the environment's: start from env.reset" in sentence(
        small_env, KEY, other, ACTION
    )
    with pytest.raises(
        KinetixError, match="expected the EnvState that an episode starts in, got a number"
    ):
        small_env.reset(KEY, None, 3)
    with pytest.raises(KinetixError, match=r"a batch of shape .2,.: use jax.vmap.env.reset"):
        small_env.reset(KEY, None, stack_states([small_state, small_state]))
    with pytest.raises(KinetixError, match="take the state out of it"):
        small_env.reset(KEY, None, load_from_json_file("s/first_flight"))
    coarse = jax.tree.map(_in_half_precision, small_state)
    assert "expected numbers in float32, got bfloat16" in sentence(small_env, KEY, coarse, ACTION)
    # And that is what works.
    _, state = small_env.reset(KEY, None, other)
    small_env.step(KEY, state, ACTION)


def _in_half_precision(x):
    x = jnp.asarray(x)
    return x.astype(jnp.bfloat16) if x.dtype == jnp.float32 else x


def test_a_batch_of_keys(small_env):
    with pytest.raises(KinetixError, match=r"one key, .* use jax.vmap.env.step. or jax.vmap.env.r"):
        small_env.reset(jax.random.split(KEY, 2))


def test_a_folder_is_its_levels(small_static, tmp_path):
    for name in ("first_flight", "goalkeeper"):
        (tmp_path / f"{name}.json").write_bytes((levels_dir() / "s" / f"{name}.json").read_bytes())
    static = static_env_params_from_size("s", physics=small_static.physics)
    starts = make_reset_fn_list_of_levels(tmp_path, static)
    named = make_reset_fn_list_of_levels(["s/first_flight", "s/goalkeeper"], static)
    for key in jax.random.split(KEY, 4):
        jax.tree.map(np.testing.assert_array_equal, starts(key), named(key))
    (tmp_path / "none").mkdir()
    with pytest.raises(KinetixError, match="expected levels, found none"):
        make_reset_fn_list_of_levels([tmp_path / "none"], static)


def test_what_is_no_level_in_a_list(small_static, small_state):
    loaded = load_from_json_file("s/first_flight")
    taken_out = "of load_from_json_file.path. take the first of three, the state"
    for levels, expected in (
        ([loaded], rf"levels\[0\]: expected a level .*, got tuple: {taken_out}"),
        (loaded, rf"levels\[1\]: expected a level .*, got StaticEnvParams: {taken_out}"),
        ([small_state, 3], r"levels\[1\]: expected a level .*, got int$"),
    ):
        with pytest.raises(KinetixError, match=expected):
            make_reset_fn_list_of_levels(levels, small_static)
    with pytest.raises(KinetixError, match=r"level: expected a level .*, got NoneType"):
        level_state(None, small_static)


def test_no_reset_function(small_static, small_state):
    env = make_kinetix_env("multi_discrete", "blind", None, EnvParams(), small_static)
    assert "auto_reset=False, so that episodes end" in sentence(env, KEY, small_state, ACTION)


def test_texts_of_records_are_short(small_env, small_state):
    assert repr(EnvParams()) == "EnvParams()"
    assert repr(StaticEnvParams(num_circles=3)) == "StaticEnvParams(num_circles=3)"
    assert repr(small_state) == (
        "<EnvState: slots for 5 polygons, 2 circles, 1 joints, 1 thrusters>"
    )
    batch = jax.tree.map(lambda x: jnp.asarray(x)[None], small_state)
    assert repr(batch).endswith(", batch (1,)>")
    env = "<KinetixEnv: symbolic_entity → multi_discrete, size s, drift>"
    assert repr(small_env) == env
    assert repr(LogWrapper(small_env)) == f"<LogWrapper of {env}>"
    assert repr(small_env.observation_type.layout) == "<Layout: size s>"
    assert repr(small_env.physics_engine).startswith("<PhysicsEngine: size s, ")
    assert repr(small_level()) == "Level('small': 3 bodies, 1 joint, 1 thruster)"


def test_bodies_of_a_state_are_changed_in_two_parts(small_state):
    with pytest.raises(KinetixError, match=r"no field 'bodies': .*state\.replace\(circle="):
        small_state.replace(bodies=small_state.bodies)


class Foreign:
    """An array of another library."""

    shape, dtype = (6,), "int64"

    def __dlpack__(self):
        raise NotImplementedError


def test_keys_and_what_is_no_array(small_env, small_state):
    action = jnp.zeros(6, int)
    key = jax.random.PRNGKey(0)
    for bad, kind in ((0, "a number"), (None, "NoneType"), (jnp.zeros(2), "an array of shape")):
        with pytest.raises(KinetixError, match=rf"expected jax\.random\.key\(seed\), got {kind}"):
            small_env.step(bad, small_state, action)
    with pytest.raises(KinetixError, match="state: expected an EnvState, got a random key"):
        small_env.step(small_state, jax.random.key(0), action)
    with pytest.raises(KinetixError, match=r"key: expected one key, got .*\(3, 2\): use jax\.vmap"):
        small_env.step(jax.random.split(key, 3), small_state, action)
    level = load_level("s/first_flight")
    with pytest.raises(KinetixError, match=r"load_from_json_file\(level\) makes a state"):
        small_env.reset(key, None, level)
    with pytest.raises(KinetixError, match="step: expected arrays and numbers, got 'left'"):
        small_env.step(key, small_state, "left")
    for bad in (np.array([None] * 6), np.array(["0"] * 6), Foreign()):
        with pytest.raises(KinetixError, match="step: expected arrays and numbers"):
            small_env.step(key, small_state, bad)
    with pytest.raises(KinetixError, match="from_dlpack takes it"):
        small_env.step(key, small_state, Foreign())
    with pytest.raises(KinetixError, match=r"action: .* \(6,\) .*, got list; .* jnp\.array"):
        small_env.step(key, small_state, [0] * 6)
    with pytest.raises(KinetixError, match="action of type complex64: expected integers"):
        small_env.step(key, small_state, jnp.zeros(6, jnp.complex64))
    with pytest.raises(KinetixError, match="state: expected an EnvState, got NoneType"):
        small_env.get_obs(None)


def test_a_batch_is_refused_where_one_state_belongs(small_env, small_state, small_static):
    batch = stack_states([small_state, small_state])
    keys = jax.random.split(KEY, 2)
    for call, told in (
        (lambda: small_env.get_obs(batch), r"jax\.vmap\(env\.get_obs\)"),
        (lambda: permute_state(KEY, batch), r"jax\.vmap\(permute_state\)\(jax\.random\.split"),
        (lambda: expand_state(batch, small_static), r"jax\.vmap\(lambda state: expand_state"),
    ):
        with pytest.raises(KinetixError, match=rf"one state, got a batch of .*\(2,\): use {told}"):
            call()
    with pytest.raises(KinetixError, match=r"one key, got .* \(2,\): use jax\.vmap\(permute_state"):
        permute_state(keys, small_state)
    with pytest.raises(KinetixError, match=r"key: expected jax\.random\.key\(seed\), got"):
        permute_state(None, small_state)
    with pytest.raises(
        KinetixError, match=r"expected StaticEnvParams, got EnvState; the order is e"
    ):
        expand_state(small_static, small_state)
    moved = jax.vmap(permute_state)(keys, batch)
    assert jax.tree.map(jnp.shape, moved) == jax.tree.map(jnp.shape, batch)


@pytest.mark.parametrize(
    "call",
    [
        lambda env, state, static: permute_state(KEY, state),
        lambda env, state, static: expand_state(state, static),
        lambda env, state, static: env.render(state),
        lambda env, state, static: make_render_pixels(EnvParams(), static)(state),
        lambda env, state, static: Agent.act(env, None, None, KEY),
        lambda env, state, static: make_reset_fn_list_of_levels(small_level(), static)(KEY),
        lambda env, state, static: make_reset_fn_sample_kinetix_level(EnvParams(), static)(KEY),
    ],
)
def test_a_forked_process_is_refused(monkeypatch, small_env, small_state, small_static, call):
    monkeypatch.setattr(forks, "_FORKED", [1])
    with pytest.raises(KinetixError, match="would hang: start it again"):
        call(small_env, small_state, small_static)


def test_pictures_of_batches_and_within_a_compiled_function(small_env, small_state):
    batch = stack_states([small_state, small_state])
    draws = r"kinetix\.make_render_pixels\(env\.env_params, env\.static_env_params\)"
    for env in (small_env, vectorize(small_env)):
        with pytest.raises(KinetixError, match=rf"\(2,\): use jax\.vmap\({draws}\)"):
            env.render(batch)
    for transform in (jax.vmap, jax.jit):
        with pytest.raises(KinetixError, match=f"no values within .*: use {draws} there"):
            transform(small_env.render)(batch if transform is jax.vmap else small_state)


def test_a_batch_is_refused_by_physics_and_reward_too(small_env, small_state):
    batch = stack_states([small_state, small_state])
    with pytest.raises(KinetixError, match=r"\(2,\): use jax\.vmap\(env\.engine_step\)"):
        small_env.engine_step(batch, jnp.zeros((2, 2)))
    with pytest.raises(KinetixError, match=r"\(2,\): use jax\.vmap\(env\.compute_reward_info\)"):
        small_env.compute_reward_info(batch)


def test_observations_of_states_of_another_size(small_env):
    larger = level_state(small_level(), static_env_params_from_size("m", physics="drift"))
    with pytest.raises(KinetixError, match=r"s \(polygons, circles, joints, thrusters\), got m: "):
        small_env.get_obs(larger)


def test_parts_of_an_environment_in_wrong_places(small_static):
    params = EnvParams()
    make = functools.partial(make_kinetix_env, "discrete", "symbolic_flat")
    with pytest.raises(KinetixError, match="expected EnvParams, got StaticEnvParams; the order is"):
        make(None, small_static, params)
    with pytest.raises(KinetixError, match="expected StaticEnvParams, got EnvParams; the order is"):
        make(None, params, params)
    for level in ("s/goalkeeper", ["s/goalkeeper"]):
        with pytest.raises(KinetixError, match=r"reset_fn: .*make_reset_fn_list_of_levels"):
            make(level, params, small_static)
    with pytest.raises(KinetixError, match="dense_reward_scale: expected a finite number, got 'a'"):
        make(None, EnvParams(dense_reward_scale="a"), small_static)


@pytest.mark.parametrize(
    ("field", "bad", "expected"),
    [
        ("max_timesteps", -1, "steps from 1, or jnp.inf for no time limit, got -1"),
        ("max_timesteps", 0, "steps from 1"),
        ("max_timesteps", 2.5, "steps from 1"),
        ("max_timesteps", None, "steps from 1"),
        ("max_timesteps", float("nan"), "steps from 1"),
        ("dt", 60, "seconds above 0 and up to 1, such as 1/60, got 60"),
        ("dt", "1/60", "seconds above 0"),
        ("clip_position", 0.0, "above 0"),
        ("base_thruster_power", float("inf"), "a finite number"),
    ],
)
def test_numbers_that_no_episode_can_be_played_with(
    small_env, small_state, small_static, field, bad, expected
):
    params = EnvParams(**{field: bad})
    expected = rf"env_params\.{field}: expected .*{expected}"
    with pytest.raises(KinetixError, match=expected):
        make_kinetix_env("discrete", "blind", None, params, small_static)
    with pytest.raises(KinetixError, match=expected):
        small_env.step(KEY, small_state, ACTION, params)
    with pytest.raises(KinetixError, match=expected):
        small_env.reset(KEY, params, small_state)


def test_parameters_that_are_traced_or_stand_for_axes_are_left_alone(small_env, small_state):
    """Trees of `in_axes` and of gradients have numbers that no parameter could have."""
    axes = jax.tree.map(lambda _: None, EnvParams()).replace(max_timesteps=0)
    limits = EnvParams(max_timesteps=jnp.array([1, 2]))
    labels = dataclasses.replace(small_state.labels, max_timesteps=jnp.int32(0))
    state = dataclasses.replace(small_state, labels=labels)
    step = jax.vmap(small_env.step, in_axes=(None, None, None, axes))
    ended = step(KEY, state, ACTION, limits)[3]
    assert ended.tolist() == [True, False]
    make_kinetix_env("discrete", "blind", None, EnvParams(max_timesteps=jnp.inf))


@pytest.mark.parametrize(
    ("field", "bad"),
    [
        ("num_polygons", 3),
        ("num_circles", -1),
        ("num_joints", 1.5),
        ("num_motor_bindings", "4"),
        ("frame_skip", 2.0),
        ("downscale", 0),
        ("screen_dim", 500),
        ("max_shape_size", 0),
    ],
)
def test_sizes_that_cannot_be(field, bad):
    static = StaticEnvParams(**{field: bad})
    with pytest.raises(KinetixError, match=rf"static_env_params\.{field}: expected .*, got"):
        make_kinetix_env("discrete", "blind", None, EnvParams(), static)


def test_unknown_physics_is_refused_where_it_is_typed(small_static):
    for make in (StaticEnvParams, small_static.replace):
        with pytest.raises(KinetixError, match="unknown physics 'accurat': expected one of jax2d"):
            make(physics="accurat")


@pytest.mark.parametrize("number", [np.array(7), jnp.int32(7), np.int64(7)])
def test_sizes_may_be_arrays_of_one_number(number):
    static = StaticEnvParams(num_polygons=number)
    assert static == StaticEnvParams(num_polygons=7)
    assert hash(static) == hash(StaticEnvParams(num_polygons=7))
    ued = UEDParams(add_shape_n_proposals=number)
    assert hash(ued) == hash(UEDParams(add_shape_n_proposals=7))


@pytest.mark.parametrize(
    ("field", "bad", "expected"),
    [
        ("max_shape_size", -5.0, "a finite number above 0, got -5.0"),
        ("circle_max_size_coeff", float("inf"), "a finite number above 0"),
        ("motor_on_chance", 1.5, "a probability from 0 to 1"),
        ("floor_prob_red", -0.1, "a finite number from 0"),
        ("motor_max_power", float("nan"), "a finite number"),
        ("add_shape_n_proposals", 0, "a whole number from 1"),
        ("inertia_model", "true", "'exact' or 'kinetix'"),
    ],
)
def test_random_levels_by_numbers_that_cannot_be_are_refused(small_static, field, bad, expected):
    ued = UEDParams(**{field: bad})
    for make in (
        lambda: make_reset_fn_sample_kinetix_level(EnvParams(), small_static, ued),
        lambda: make_reset_fn_sample_sizes(small_static, ued),
        lambda: sample_kinetix_level(KEY, None, EnvParams(), small_static, ued),
    ):
        with pytest.raises(KinetixError, match=rf"ued_params\.{field}: expected {expected}"):
            make()


def test_random_levels_of_something_else_are_refused(small_env, small_static):
    params, engine = EnvParams(), small_env.physics_engine
    for arguments, expected in (
        ((None, small_static, params), "expected EnvParams, got StaticEnvParams; the order is"),
        (
            (small_env, params, small_static),
            r"expected env\.physics_engine, got KinetixEnv; the or",
        ),
        ((engine, params, small_static, 3), r"ued_params: expected UEDParams.*, got int"),
    ):
        with pytest.raises(KinetixError, match=expected):
            sample_kinetix_level(KEY, *arguments)
    several = make_reset_fn_list_of_levels([small_level(), small_level()], small_static)
    for draw in (make_reset_fn_sample_kinetix_level(params, small_static), several):
        for key, expected in (
            (3, r"key: expected jax\.random\.key\(seed\), got 3|got int"),
            (jax.random.split(KEY, 3), r"expected one key, .* \(3,\): use jax\.vmap\(reset_fn\)"),
        ):
            with pytest.raises(KinetixError, match=expected):
                draw(key)


@pytest.mark.parametrize("sides", [[400, 300], np.array([400, 300])], ids=["list", "array"])
def test_sides_of_the_screen_may_be_any_sequence(sides):
    static = static_env_params_from_size("s").replace(screen_dim=sides)
    assert static.screen_dim == (400, 300)
    hash(static)


def test_choices_that_do_not_exist(small_env, small_state, small_static):
    assert sentence(small_env, KEY, small_state, ACTION.at[0].set(3)) == (
        "action [3, 0, 0, 0, 0, 0]: expected whole numbers from 0 and below 3, 3, 3, 3, 2, 2 "
        "(multi_discrete); under jit a choice that does not exist drives nothing"
    )
    single = make_kinetix_env("discrete", "blind", lambda key: small_state, None, small_static)
    for bad in (-1, np.int64(11), jnp.array(42)):
        assert "expected whole numbers from 0 and up to 10" in sentence(
            single, KEY, small_state, bad
        )
    # Where values are not known they cannot be refused.
    jax.jit(small_env.step)(KEY, small_state, ACTION + 7)


def test_wrappers_around_nothing_and_other_things_in_the_place_of_a_state(small_static):
    for wrap in (LogWrapper, vectorize):
        with pytest.raises(KinetixError, match="env: expected an environment, got NoneType"):
            wrap(None)
    with pytest.raises(KinetixError, match=r"got EnvParams; the order is permute_state\(key"):
        permute_state(KEY, EnvParams(), small_static)
    with pytest.raises(KinetixError, match="the order is make_reset_fn_sample_kinetix_level"):
        make_reset_fn_sample_kinetix_level(small_static, EnvParams())
    with pytest.raises(KinetixError, match=r"ued_params: expected UEDParams.*, got dict"):
        make_reset_fn_sample_kinetix_level(EnvParams(), small_static, {})
    with pytest.raises(KinetixError, match="size None: expected s, m, l"):
        static_env_params_from_size(None)


def test_pictures_of_what_is_no_state(small_env, small_state, small_static):
    render = make_render_pixels(EnvParams(), small_static)
    with pytest.raises(KinetixError, match=r"got LogState \(its field env_state is one\)"):
        render(LogWrapper(small_env).reset(KEY, None, small_state)[1])
    with pytest.raises(KinetixError, match=r"a batch of shape \(1,\): use jax.vmap\(render\)"):
        render(jax.tree.map(lambda x: jnp.asarray(x)[None], small_state))
    with pytest.raises(KinetixError, match="in this order, got StaticEnvParams, EnvParams"):
        make_render_pixels(small_static, EnvParams())
    with pytest.raises(KinetixError, match="downscale=501: expected 1 up to the sides"):
        make_render_pixels(EnvParams(), small_static.replace(downscale=501))


def test_one_world_where_many_are_expected(small_env, small_state):
    with pytest.raises(KinetixError, match=r"a single one: jax\.random\.split"):
        vectorize(small_env).reset(KEY, None, small_state)


def test_classes_and_solvers_of_ones_own_are_taken(small_env):
    class Mine(type(small_env.observations)):
        name = "mine"

    env = make_kinetix_env("discrete", Mine, None, EnvParams(), small_env.static_env_params)
    assert env.observations == Mine(layout=env.observations.layout)
    solver = solver_named("jax2d")
    static = dataclasses.replace(small_env.static_env_params, physics=solver)
    assert (
        physics_engine(static).solver
        == physics_engine(dataclasses.replace(static, physics="jax2d")).solver
    )
    with pytest.raises(KinetixError, match="AbstractObservation"):
        make_kinetix_env("discrete", dict)
    with pytest.raises(KinetixError, match="name or a solver"):
        physics_engine(dataclasses.replace(static, physics=3))


@pytest.mark.parametrize("kind", [np.int64, np.uint8, bool, np.int32, jnp.int8])
def test_whole_numbers_of_every_type_are_one_action(kind):
    """Each type would compile a step of its own."""
    key, state = object(), object()
    for given in (np.ones(6, kind), jnp.array(np.ones(6, kind))):
        positional, _ = with_usual_action((key, state, given), {})
        _, named = with_usual_action((key, state), {"action": given})
        for action in (positional[2], named["action"]):
            assert action.dtype == np.int32 and (np.asarray(action) == 1).all()
    real = np.ones(6, np.float32)
    assert with_usual_action((key, state, real), {})[0][2] is real


def test_states_of_several_sizes_are_not_stacked():
    small, large = (
        level_state(name, static_env_params_of(SIZES[name[0]]))
        for name in ("s/first_flight", "l/rover_ridge")
    )
    assert stack_states([small, small]).timestep.shape == (2,)
    with pytest.raises(KinetixError, match="of one size to stack, got states of several sizes"):
        stack_states([small, large])
    with pytest.raises(KinetixError, match="got none"):
        stack_states([])


@pytest.mark.parametrize(
    "number", [jnp.float32(0.5), np.array(0.5, np.float32), np.float32(0.5), jnp.asarray(0.5)]
)
def test_parameters_of_an_environment_may_be_arrays_of_one_number(number):
    params = EnvParams(dense_reward_scale=number)
    env = make_kinetix_env(env_params=params, create_dummy_env=True)
    assert hash(env.env.env_params) == hash(EnvParams(dense_reward_scale=0.5))


def test_parameters_that_are_no_number_are_refused(small_env, small_state):
    several = EnvParams(dt=jnp.ones(3))
    with pytest.raises(KinetixError, match=r"env_params\.dt: expected a number, got shape \(3,\)"):
        make_kinetix_env(env_params=several)
    assert "jax.vmap(env.step" in sentence(small_env, KEY, small_state, ACTION, several)

    def traced(dt):
        make_kinetix_env(env_params=EnvParams(dt=dt))

    with pytest.raises(KinetixError, match="got a traced value: make the environment with usual"):
        jax.jit(traced)(0.01)


@pytest.mark.parametrize("name", ["auto_reset", "create_dummy_env", "keep_terminal_observation"])
def test_a_word_is_no_truth(name):
    with pytest.raises(KinetixError, match=f"{name}='no': expected True or False"):
        make_kinetix_env(**{name: "no"})


def test_a_level_is_named_where_a_state_belongs(small_env):
    with pytest.raises(KinetixError, match=r"got 's/goalkeeper'; kinetix\.load_from_json_file"):
        small_env.reset(KEY, EnvParams(), "s/goalkeeper")


@pytest.mark.parametrize("levels", [None, 3])
def test_levels_that_are_none_are_refused(levels):
    with pytest.raises(KinetixError, match="levels: expected levels, their files or a level set"):
        make_reset_fn_list_of_levels(levels, StaticEnvParams())


def test_levels_need_sizes():
    with pytest.raises(
        KinetixError, match=r"make_reset_fn_list_of_levels\(levels, static_env_params\)"
    ):
        make_reset_fn_list_of_levels(StaticEnvParams(), ["s/goalkeeper"])


def test_a_permutation_beyond_the_seeds_is_refused():
    for number in (2**32, 10**22):
        with pytest.raises(KinetixError, match=r"expected \.permuteN with N from 0 to 4294967295"):
            load_from_json_file(f"s/goalkeeper.permute{number}")


@pytest.mark.parametrize(
    "name", ["reset.level_state", "devices.spread", "gymnax.GymnaxAdapter", "generators.filters"]
)
def test_modules_that_documents_name_need_no_import_of_their_own(name):
    found = kinetix.environment
    for part in name.split("."):
        found = found.__getattr__(part) if hasattr(found, "__path__") else getattr(found, part)
