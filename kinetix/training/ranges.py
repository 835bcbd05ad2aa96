"""Ranges of hyper-parameters, a row each: what lies outside cannot be learnt with."""

import math
from typing import Any, Final

from kinetix.bounds import LAST_SEED, Bound, check_bounds

_RANGES: Final = (
    Bound(
        (
            *("num_train_envs", "num_steps", "num_minibatches", "update_epochs", "frame_skip"),
            *("checkpoint_save_freq", "eval_num_attempts", "level_filter_sample_ratio"),
            *("batch_size", "num_batches", "rollout_steps", "num_to_save", "train_buffer_size"),
            *("buffer_update_frequency", "rollout_episodes", "outer_rollout_steps"),
            *("level_buffer_capacity", "topk_k"),
        ),
        "at least 1",
        lambda x: x >= 1,
    ),
    Bound(
        (
            *("eval_freq", "video_frequency", "eval_sampled_levels", "level_filter_n_steps"),
            *("num_edits", "critic_warmup"),
        ),
        "at least 0",
        lambda x: x >= 0,
    ),
    Bound(("seed",), f"0 … {LAST_SEED}", lambda x: 0 <= x <= LAST_SEED),
    Bound(
        ("peak_lr", "max_grad_norm", "clip_eps", "temperature"),
        "a finite number above 0",
        lambda x: 0 < x < math.inf,
    ),
    Bound(
        ("learning_rate", "initial_lr", "vf_coef", "teacher_coef"),
        "a finite number, at least 0",
        lambda x: 0 <= x < math.inf,
    ),
    Bound(
        (
            *("gamma", "gae_lambda", "warmup_frac", "teacher_frac", "demo_starts"),
            *("sampled_envs_ratio", "replay_prob", "staleness_coeff", "minimum_fill_ratio"),
        ),
        "0 … 1",
        lambda x: 0 <= x <= 1,
    ),
    Bound(("ent_coef", "dense_reward_scale"), "a finite number", math.isfinite),
)


def check_ranges(config: Any) -> None:
    """Refuse a configuration with a number that lies outside of its range.

    Args:
        config: Any; fields that it lacks are left out.

    Raises:
        KinetixError: The sentence names the field.
    """
    check_bounds(config, _RANGES)
