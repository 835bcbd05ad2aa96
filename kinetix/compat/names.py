"""Every public name of kinetix-env 3, and those of 0.x and 1.x that projects still use.

One row per module: where each name lives here, or what to use instead. docs/migrating.md is made
from this table. Free of JAX.
"""

import dataclasses
import importlib
import warnings
from collections.abc import Mapping
from typing import Any, Final


@dataclasses.dataclass(frozen=True, kw_only=True)
class Place:
    """Place of a name of kinetix-env in this package."""

    home: str = ""
    """The module that has it; empty where there is no such thing here."""
    name: str = ""
    """Its name there."""
    instead: str = ""
    """Replacement, where there is no such thing or where the name is an old one."""

    @property
    def old(self) -> bool:
        """True if kinetix-env itself has dropped the name."""
        return bool(self.home and self.instead)


Names = dict[str, Place]


def _at(home: str, *names: str, **renamed: str) -> Names:
    """Return names that live in one module; `there=here` where they are called otherwise."""
    same = {name: Place(home=home, name=name) for name in names}
    return same | {there: Place(home=home, name=here) for there, here in renamed.items()}


def _old(home: str, instead: str, **names: str) -> Names:
    """Return names of 0.x and 1.x, which warn."""
    return {there: Place(home=home, name=here, instead=instead) for there, here in names.items()}


def _none(instead: str, *names: str) -> Names:
    """Return names without a counterpart."""
    return dict.fromkeys(names, Place(instead=instead))


_PARAMS: Final = "kinetix.environment.params"
_STATE: Final = "kinetix.environment.state"
_SPACES: Final = "kinetix.environment.spaces"
_COMPAT: Final = "kinetix.compat"
_PICKLES: Final = (
    "pickles are not read, because loading one can run code; kinetix.load_agent reads "
    "params.safetensors with config.json, and kinetix.save_agent writes it"
)
_TRAINING: Final = "use kinetix.training.train, or the loop of examples/ppo.py"
_EVALUATION: Final = "use kinetix.agents.evaluate.evaluate, or the command `kinetix eval`"
_BUILD: Final = "use kinetix.LevelBuilder, or a kinetix.Level and kinetix.environment.reset"
_GENERATORS: Final = "its counterparts are in kinetix.environment.generators"
_BACK: Final = "use kinetix.environment.inverse.state_from_entities or state_from_flat"
_FEATURES: Final = "use env.get_obs, or kinetix.environment.observations, whose columns have names"
_NETWORKS: Final = "use kinetix.models.make_network_from_config, or kinetix.agents.networks"

_ACTIONS: Final = _at(
    f"{_COMPAT}.kinds",
    "MultiDiscreteActions",
    "DiscreteActions",
    "ContinuousActions",
    KinetixAction="AbstractAction",
)
_OBSERVATIONS: Final = _at(
    f"{_COMPAT}.kinds",
    "SymbolicPaddedObservations",
    "EntityObservations",
    "SymbolicObservations",
    "PixelObservations",
    KinetixObservation="AbstractObservation",
)
_WRAPPERS: Final = _at(f"{_COMPAT}.wrappers", "GymnaxWrapper") | _old(
    f"{_COMPAT}.wrappers",
    "make_kinetix_env(…, auto_reset=True), and pass a level as override_reset_state",
    UnderspecifiedEnvWrapper="UnderspecifiedEnvWrapper",
    AutoReplayWrapper="AutoReplayWrapper",
    AutoResetWrapper="AutoResetWrapper",
    DenseRewardWrapper="DenseRewardWrapper",
    UnderspecifiedToGymnaxWrapper="UnderspecifiedToGymnaxWrapper",
)
_RESETS: Final = _at(
    "kinetix.environment.reset",
    "make_reset_fn_list_of_levels",
    "make_reset_fn_sample_kinetix_level",
) | _at(
    f"{_COMPAT}.ued",
    "make_reset_fn_from_config",
    "make_reset_fn_sample_empty_level",
    "make_reset_fn_sample_kinetix_level_different_static_env_params",
    "make_vmapped_filtered_level_sampler",
    "make_mutate_env",
)
_UTILS: Final = (
    _at("kinetix.environment.rearrange", "permute_state")
    | _at(_PARAMS, "static_env_params_from_size")
    | _at(
        f"{_COMPAT}.states",
        "create_empty_env",
        "index_motor_actions",
        "index_thruster_actions",
        "convert_continuous_actions",
        "convert_discrete_actions",
        "convert_multi_discrete_actions",
    )
)
_ENV_STATE: Final = _at(_STATE, "EnvState") | _at(_PARAMS, "EnvParams", "StaticEnvParams")
_TYPES: Final = _at(_SPACES, "ActionType", "ObservationType", "MultiDiscrete")
_UED_PARAMS: Final = _at("kinetix.environment.generators.params", "UEDParams")
_SAMPLE: Final = _at("kinetix.environment.generators.sample", "sample_kinetix_level")
_STARTS: Final = _at(f"{_COMPAT}.ued", "create_random_starting_distribution")

_CONFIG: Final = _at(
    f"{_COMPAT}.config",
    "normalise_config",
    "generate_params_from_config",
    "get_eval_level_groups",
    "get_video_frequency",
    "get_hash_without_seed",
    "get_date",
    "get_tags",
) | _at(f"{_COMPAT}.artefacts", "init_wandb")
_STATISTICS: Final = _at(
    f"{_COMPAT}.statistics",
    "RunningMeanStandard",
    "rms_init",
    "rms_normalise",
    "rms_init_from_batch",
)
_SAVING: Final = (
    _at("kinetix.environment.reset", "load_from_json_file")
    | _at(
        f"{_COMPAT}.saving",
        "load_evaluation_levels",
        "export_env_state_to_json",
        "get_env_state_from_json",
        "expand_env_state",
        "load_pretrained_checkpoint",
        "save_pretrained_checkpoint",
    )
    | _at(f"{_COMPAT}.artefacts", "save_model", "load_train_state_from_wandb_artifact_path")
    | _none(_PICKLES, "save_pickle")
)
_EVAL_UTILS: Final = _at(
    f"{_COMPAT}.evaluation", "EpisodeMetrics", "EvalSpec", "make_eval_fn"
) | _none(
    _EVALUATION,
    "create_eval_metrics_dict_for_logging",
    "make_video_fn",
    "make_fake_video",
)
_LEARNING: Final = _at(f"{_COMPAT}.evaluation", "general_eval", "no_op_and_random_rollout") | _none(
    _TRAINING, "sample_trajectories_and_learn"
)
_BC_TYPES: Final = _at(
    f"{_COMPAT}.data", "ActionEnvStateMask", "RunnerState", "RunnerStateAndData", "TrainAndValData"
)
_DATASETS: Final = _at(f"{_COMPAT}.data", "ShuffledDatasetManager", "TrajectoryDatasetManager")
_NETWORK: Final = _at(f"{_COMPAT}.models", "make_network_from_config")
_HEADS: Final = _at("kinetix.agents.networks.recurrent", "ScannedRNN") | _at(
    f"{_COMPAT}.models", "GeneralActorCriticRNN"
)
_DISTRIBUTION: Final = _at(f"{_COMPAT}.models", "MultiDiscreteActionDistribution")
_MUTATIONS: Final = (
    "mutate_add_shape",
    "mutate_add_connected_shape",
    "mutate_add_connected_shape_proper",
    "mutate_remove_shape",
    "mutate_remove_joint",
    "mutate_swap_role",
    "mutate_toggle_fixture",
    "mutate_add_thruster",
    "mutate_change_gravity",
    "mutate_remove_thruster",
    "make_mutate_change_shape_size",
    "mutate_change_shape_location",
    "make_mutate_change_shape_rotation",
)
_PIXELS: Final = _at("kinetix.render.pixels", "make_render_pixels", "make_render_pixels_rl") | _at(
    "kinetix.environment.observations.pixels", PixelsObservation="PixelObservation"
)
_ENTITIES: Final = _at(f"{_COMPAT}.renderers", "make_render_entities")
_SYMBOLIC: Final = _at(f"{_COMPAT}.renderers", "make_render_symbolic")

MODULES: Final[Mapping[str, Names]] = {
    "kinetix.data": _BC_TYPES | _DATASETS | _at(f"{_COMPAT}.data", "get_valid_action_mask"),
    "kinetix.data.bc_types": _BC_TYPES,
    "kinetix.data.bc_utils": _at(
        f"{_COMPAT}.data",
        "get_valid_action_mask",
        get_valid_action_mask_np="get_valid_action_mask",
    )
    | _none("a data set here holds named arrays already", "map_raw_dict_to_action_env_state"),
    "kinetix.data.data_utils": _DATASETS
    | _none(
        "use kinetix.data.ShuffledDatasetManager or TrajectoryDatasetManager",
        "PostBatchWrapper",
        "ZarrBatchDataSource",
        "MultiFileBatchDataSource",
        "ZarrTrajDataSource",
    ),
    "kinetix.data.expanding_utils": _at(
        f"{_COMPAT}.saving",
        expand_env_state_numpy="expand_env_state",
        expand_env_state_numpy_batched="expand_env_states",
    ),
    "kinetix.environment": _UTILS
    | _RESETS
    | _ACTIONS
    | _OBSERVATIONS
    | _TYPES
    | _STARTS
    | _ENV_STATE
    | _UED_PARAMS
    | _SAMPLE
    | _at("kinetix.environment.env", "KinetixEnv", "make_kinetix_env")
    | _at("kinetix.environment.wrappers", "LogWrapper"),
    "kinetix.environment.env": _OBSERVATIONS
    | _ACTIONS
    | _TYPES
    | _ENV_STATE
    | _at("kinetix.environment.env", "KinetixEnv", "make_kinetix_env", KinetixDummyEnv="DummyEnv")
    | _old(
        f"{_COMPAT}.older",
        "make_kinetix_env(action_type, observation_type, reset_fn, env_params, static_env_params)",
        make_kinetix_env_from_name="make_kinetix_env_from_name",
        make_kinetix_env_from_args="make_kinetix_env_from_args",
    )
    | _old(
        f"{_COMPAT}.states",
        "kinetix.environment.utils.create_empty_env",
        create_empty_env="create_empty_env",
    )
    | _old(
        f"{_COMPAT}.older",
        "kinetix.environment.KinetixEnv, or gymnax.environments.environment",
        environment="Environments",
    ),
    "kinetix.environment.env_state": _ENV_STATE,
    "kinetix.environment.spaces": _ACTIONS
    | _OBSERVATIONS
    | _TYPES
    | _ENV_STATE
    | _at(f"{_COMPAT}.kinds", "BlindObservations"),
    "kinetix.environment.utils": _UTILS
    | _TYPES
    | _OBSERVATIONS
    | _old(
        "kinetix.environment.rearrange",
        "kinetix.environment.permute_state",
        permute_pcg_state="permute_state",
    ),
    "kinetix.environment.wrappers": _WRAPPERS
    | _at("kinetix.environment.wrappers", "LogWrapper", LogEnvState="LogState"),
    "kinetix.environment.ued": {},
    "kinetix.environment.ued.distributions": _SAMPLE
    | _STARTS
    | _at(
        f"{_COMPAT}.ued",
        create_vmapped_filtered_distribution="create_vmapped_filtered_distribution",
    ),
    "kinetix.environment.ued.locomotion_distribution": _at(
        f"{_COMPAT}.ued", "sample_locomotion_level", "make_reset_fn_custom_distribution"
    )
    | _none(
        "its counterparts are in kinetix.environment.generators.locomotion",
        "AugmentedRigidbody",
        "add_poly_connection",
        "fix_out_of_bounds",
        "add_goal",
        "randomise_floor_colour",
        "make_get_dims_fn",
    )
    | _at(f"{_COMPAT}.draws", "sample_uniform_and_exclude", "sample_uniform"),
    "kinetix.environment.ued.mutators": _at(f"{_COMPAT}.mutators", *_MUTATIONS),
    "kinetix.environment.ued.ued": _RESETS
    | _UED_PARAMS
    | _old(
        f"{_COMPAT}.older",
        "make_reset_fn_from_config, or another of the make_reset_fn_… functions",
        make_reset_train_function_with_mutations="make_reset_train_function_with_mutations",
        make_reset_train_function_with_list_of_levels=(
            "make_reset_train_function_with_list_of_levels"
        ),
    ),
    "kinetix.environment.ued.ued_state": _UED_PARAMS,
    "kinetix.environment.ued.util": _at(
        f"{_COMPAT}.states",
        "make_velocities_zero",
        "is_space_for_shape",
        "is_space_for_joint",
        "are_there_shapes_present",
        "count_roles",
        "rectangle_vertices",
    )
    | _none(
        _BUILD,
        "add_rigidbody_to_state",
        "add_rectangle_to_state",
        "add_circle_to_state",
        "add_thruster_to_object",
    )
    | _none(
        _GENERATORS,
        "sample_dimensions",
        "get_role",
        "make_do_dummy_step",
    )
    | _at(
        f"{_COMPAT}.draws",
        "random_position_on_triangle",
        "random_position_on_rectangle",
        "random_position_on_polygon",
        "random_position_on_circle",
    ),
    "kinetix.models": _NETWORK | _HEADS | _DISTRIBUTION,
    "kinetix.models.action_spaces": _DISTRIBUTION
    | _none(
        "kinetix.agents.networks.distributions has the three kinds of action",
        "HybridAction",
        "HybridActionDistribution",
    )
    | _at("kinetix.agents.networks.distributions", TemperatureCategorical="Categorical"),
    "kinetix.models.actor_critic": _HEADS
    | _at("kinetix.agents.networks.mlp", "MultiHeadDense")
    | _none(_NETWORKS, "DenseAndActivation", "ResNetBasicBlock")
    | _at(
        f"{_COMPAT}.networks",
        "ActorCriticPixelsRNN",
        "ActorCriticSymbolicRNN",
        "ActorCriticPermutationInvariantSymbolicRNN",
    ),
    "kinetix.models.rel_multi_head": _none(
        "use flax.linen.MultiHeadDotProductAttention",
        "dot_product_attention_weights",
        "dot_product_attention",
        "RelMultiHeadDotProductAttention",
        "SelfAttention",
    )
    | _at("flax.linen", "make_attention_mask", "make_causal_mask", "combine_masks"),
    "kinetix.models.transformer_model": _none(
        _NETWORKS,
        "Gating",
        "transformer_layer",
        "ThrusterAndJointBlock",
        "Transformer",
    )
    | _at(f"{_COMPAT}.networks", "ActorCriticTransformer"),
    "kinetix.models.utils": _NETWORK,
    "kinetix.render": _at("kinetix.render.pixels", "make_render_pixels", "make_render_pixels_rl")
    | _ENTITIES
    | _SYMBOLIC,
    "kinetix.render.inverse_renderer_common": _none(
        _BACK, "features_to_rigidbody", "features_to_thruster", "features_to_joint"
    ),
    "kinetix.render.renderer_pixels": _PIXELS,
    "kinetix.render.renderer_symbolic_common": _none(
        _FEATURES,
        "add_circle_features",
        "make_circle_features",
        "add_polygon_features",
        "make_polygon_features",
        "make_unified_shape_features",
        "make_joint_features",
        "make_thruster_features",
    ),
    "kinetix.render.renderer_symbolic_entity": _ENTITIES
    | _at("kinetix.environment.observations.entities", "EntityObservation")
    | _at(f"{_COMPAT}.renderers", "make_inverse_render_entity"),
    "kinetix.render.renderer_symbolic_flat": _SYMBOLIC
    | _at(f"{_COMPAT}.renderers", "make_inverse_render_symbolic"),
    "kinetix.util": _CONFIG
    | _LEARNING
    | _STATISTICS
    | _EVAL_UTILS
    | _SAVING
    | _at(f"{_COMPAT}.statistics", "maybe_normalise", "parallel_rms_update")
    | _at(f"{_COMPAT}.timing", "time_function"),
    "kinetix.util.config": _CONFIG
    | _none(
        "metrics.jsonl and metrics.csv of a training run hold its data",
        "save_data_to_local_file",
        "compress_log_files_after_run",
    )
    | _old(
        f"{_COMPAT}.older",
        "UEDParams(…)",
        generate_ued_params_from_config="generate_ued_params_from_config",
    ),
    "kinetix.util.eval_utils": _EVAL_UTILS
    | _at(f"{_COMPAT}.evaluation", "RenderMetrics", "EvalMetrics", "KinetixVideo"),
    "kinetix.util.learning": _LEARNING
    | _STATISTICS
    | _at(f"{_COMPAT}.evaluation", "evaluate_rnn", "compute_gae", "no_op_rollout")
    | _at(f"{_COMPAT}.statistics", "rms_should_normalise", "rms_is_leaf", "rms_update")
    | _none(_TRAINING, "sample_trajectories_rnn", "update_actor_critic_rnn")
    | _old(
        f"{_COMPAT}.older",
        "kinetix.util.saving.load_evaluation_levels",
        get_eval_levels="get_eval_levels",
    )
    | _old(f"{_COMPAT}.saving", "kinetix.paths.levels_dir()", BASE_DIR="BASE_DIR"),
    "kinetix.util.learning_utils": _at(
        f"{_COMPAT}.statistics", "maybe_normalise", "parallel_rms_update"
    ),
    "kinetix.util.saving": _SAVING
    | _at(
        f"{_COMPAT}.saving",
        "BASE_DIR",
        "get_correct_path_of_json_level",
        "check_if_mass_and_inertia_are_correct",
        "stack_list_of_pytrees",
        "save_params",
        "load_params",
        "import_env_state_from_json",
    )
    | _none(
        _PICKLES,
        "load_world_state_pickle",
        "my_load_file",
        "my_save_file",
        "save_dict",
    )
    | _at(
        f"{_COMPAT}.artefacts",
        "load_params_from_wandb_artifact_path",
        "save_params_to_wandb",
        load_params_wandb_artifact_path_full_model="load_params_from_wandb_artifact_path",
    )
    | _old(
        f"{_COMPAT}.artefacts",
        "kinetix.util.saving.save_model",
        save_model_to_wandb="save_model",
    ),
    "kinetix.util.timing": _at(f"{_COMPAT}.timing", "time_function"),
    "kinetix.util.train_utils": _at(f"{_COMPAT}.statistics", "EMA", "weight_norm")
    | _at(f"{_COMPAT}.timing", "get_logger")
    | _at(f"{_COMPAT}.ued", "make_env")
    | _none(
        _TRAINING,
        "get_randomly_sampled_eval_levels",
        "get_config_from_checkpoint_path",
        "compute_gns_metrics",
    ),
}
"""The names of each module of kinetix-env."""

_warned: set[tuple[str, str]] = set()


def find(module: str, name: str) -> Any:
    """Return what a name of kinetix-env stands for.

    Args:
        module: A module of `MODULES`.
        name: One of its names.

    Raises:
        ImportError: The name has no counterpart here; the message says what to use.
    """
    place = MODULES[module][name]
    if not place.home:
        raise ImportError(f"{module}.{name} does not exist here: {place.instead}", name=name)
    if place.old and (module, name) not in _warned:
        _warned.add((module, name))
        warnings.warn(
            f"{module}.{name} is a name of kinetix-env before 2.0: use {place.instead}",
            FutureWarning,
            stacklevel=3,
        )
    return getattr(importlib.import_module(place.home), place.name)
