"""Warnings about settings under which a training wastes work."""

import math

from kinetix.training.config import BcConfig, ReplayConfig, SflConfig
from kinetix.training.setup import Setup
from kinetix.wording import plural


def cut_short(setup: Setup) -> str:
    """Return why long episodes are not scored or learnt from to their end; else nothing.

    Args:
        setup: The training.
    """
    config, longest = setup.config, setup.longest_episode
    if isinstance(config, ReplayConfig):
        played = config.num_steps * config.outer_rollout_steps
        if played < longest:
            return (
                f"num_steps × outer_rollout_steps = {played} is less than the longest episode "
                f"({longest} steps): later steps are never learnt from, and levels that last "
                "so long have no score"
            )
    if isinstance(config, SflConfig) and config.learnability_mode == "timesteps":
        played = config.rollout_steps
        if played < 2 * longest:
            return (
                f"rollout_steps = {played} is less than two of the longest episodes ({longest} "
                "steps each): levels are scored by their short episodes"
            )
    return ""


def learns_nothing(setup: Setup) -> str:
    """Return why a training learns or replays nothing; else nothing.

    Args:
        setup: The training.
    """
    config = setup.config
    if not config.learning_updates:
        return (
            "nothing is learnt: exploratory_grad_updates = false leaves that to replays, and "
            "replay_prob is 0"
        )
    if config.critic_warmup >= config.learning_updates and not isinstance(config, BcConfig):
        return (
            f"the policy never learns: critic_warmup = {config.critic_warmup} is no less than "
            f"the {plural(config.learning_updates, 'update')} that learn"
        )
    if not isinstance(config, ReplayConfig) or not config.replay_prob:
        return ""
    enough = max(math.ceil(config.minimum_fill_ratio * config.level_buffer_capacity), 1)
    if config.buffer_duplicate_check and 0 < setup.different < enough:
        return (
            f"nothing is ever replayed: the buffer takes no level twice, there are "
            f"{plural(setup.different, 'level')}, and minimum_fill_ratio × "
            f"level_buffer_capacity = {enough} are needed"
        )
    return ""
