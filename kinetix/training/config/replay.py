"""Hyper-parameters of level replay: PLR, ACCEL and domain randomisation."""

import dataclasses
import math
from typing import ClassVar, Literal

from kinetix.training.config.ppo import PpoConfig

ScoreFunction = Literal["MaxMC", "pvl", "learnability"]
Prioritization = Literal["rank", "topk"]


@dataclasses.dataclass(frozen=True, kw_only=True)
class ReplayConfig(PpoConfig):
    """Prioritised level replay; with `replay_prob` 0 it is domain randomisation (DR)."""

    size: str = "s"
    """s, m, l, locomotion, or four capacities such as 12,4,6,2."""
    outer_rollout_steps: int = 4
    """Rollouts (and updates) on the same levels before they are scored."""
    use_accel: bool = False
    """Mutate the levels of every replay."""
    num_edits: int = 2
    """Edits of a mutation."""
    score_function: ScoreFunction = "MaxMC"
    """Score that makes a level worth replaying."""
    level_buffer_capacity: int = 4000
    """Size of the buffer."""
    replay_prob: float = 0.5
    """Probability of a replay, once the buffer is full enough."""
    staleness_coeff: float = 0.3
    """Weight of not having been replayed for long."""
    prioritization: Prioritization = "rank"
    """Mapping from scores to weights."""
    temperature: float = 1.0
    """Weights are proportional to (1/rank) to the power 1/temperature."""
    topk_k: int = 8
    """Number of the best levels, which share the weight under `topk`."""
    minimum_fill_ratio: float = 0.5
    """Share of the buffer that must be filled before the first replay."""
    exploratory_grad_updates: bool = True
    """Learn on new and mutated levels too (else only on replayed ones)."""
    buffer_duplicate_check: bool = False
    """Keep no level twice."""
    accel_start_from_empty: bool = True
    """Let ACCEL's new levels be nearly empty ones (false where `levels` or `level_mode` name
    others)."""

    eval_freq: int = 50
    """Updates between two evaluations; 0: none."""

    update_size: ClassVar[tuple[str, ...]] = (*PpoConfig.update_size, "outer_rollout_steps")

    @property
    def replay_share(self) -> float:
        """Share of the updates that are replays, once the buffer is full enough."""
        # Under ACCEL a mutation follows every replay, so the choice is made in all other steps.
        return self.replay_prob / (1 + self.replay_prob * self.use_accel)

    @property
    def rollouts_per_update(self) -> int:
        """See `PpoConfig`."""
        return self.outer_rollout_steps

    @property
    def learning_updates(self) -> int:
        """See `PpoConfig`; an estimate where replays alone are learnt from."""
        if self.exploratory_grad_updates or self.parity is not None:
            return self.num_updates
        return math.ceil(self.num_updates * self.replay_share)

    @property
    def only_listed(self) -> bool:
        """See `PpoConfig`; mutations make levels that have other things."""
        return super().only_listed and not self.use_accel
