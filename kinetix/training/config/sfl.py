"""Hyper-parameters of sampling for learnability (SFL)."""

import dataclasses
from typing import Literal

from kinetix.errors import KinetixError
from kinetix.training.config.ppo import PpoConfig

LearnabilityMode = Literal["timesteps", "episodes"]


@dataclasses.dataclass(frozen=True, kw_only=True)
class SflConfig(PpoConfig):
    """Sampling for learnability: train on levels that are sometimes solved."""

    num_steps: int = 256
    """Environment steps of a rollout."""
    sampled_envs_ratio: float = 0.5
    """Share of the environments that play levels of the buffer; 0 is domain randomisation."""
    batch_size: int = 16_384
    """Random levels that are scored at once."""
    num_batches: int = 16
    """Number of such batches in a scoring."""
    rollout_steps: int = 512
    """Length of each of their rollouts [environment steps]."""
    num_to_save: int = 8192
    """Size of the buffer."""
    buffer_update_frequency: int = 50
    """Updates between two scorings."""
    learnability_mode: LearnabilityMode = "timesteps"
    """A level is played for `rollout_steps` (`timesteps`), or for its first `rollout_episodes`
    episodes (`episodes`)."""
    rollout_episodes: int = 10
    """Episodes a level in the mode `episodes`."""
    learnability_correction: bool = True
    """p(1 − p)·n/(n + 1) instead of p(1 − p), for n finished episodes."""
    train_on_buffer: bool = False
    """Take all levels from a fixed set of random ones instead of drawing ever new ones."""
    train_buffer_size: int = 8192
    """Size of that set."""
    put_eval_levels_in_buffer: bool = False
    """Let the evaluation levels take the last places of the buffer; results on them are then no
    longer those of unseen levels."""
    log_learnability_before_after: bool = False
    """Play the buffer's levels once more before and after they are trained on, for the metrics."""

    def uneven(self, devices: int) -> str:
        """See `PpoConfig`; levels are scored on all devices too."""
        odd = super().uneven(devices)
        if not self.drawn_envs:
            return odd
        odd = odd or self._no_multiple("batch_size", devices)
        if self.log_learnability_before_after:
            odd = odd or self._no_multiple("num_to_save", devices)
        return odd

    def check(self) -> None:
        """Refuse settings that cannot work, as `PpoConfig.check` does."""
        super().check()
        if self.num_to_save > self.batch_size * self.num_batches:
            raise KinetixError(
                f"num_to_save = {self.num_to_save} is more than the batch_size × num_batches = "
                f"{self.batch_size * self.num_batches} levels that are scored"
            )
        if self.sampled_envs_ratio and not self.drawn_envs:
            raise KinetixError(
                f"sampled_envs_ratio = {self.sampled_envs_ratio:g} of num_train_envs = "
                f"{self.num_train_envs} is less than one environment: none would play levels that "
                "were scored; expected more of either, or 0 for domain randomisation"
            )

    @property
    def drawn_envs(self) -> int:
        """Environments that play levels of the buffer."""
        return int(self.sampled_envs_ratio * self.num_train_envs)

    @property
    def only_listed(self) -> bool:
        """See `PpoConfig`; evaluation levels in the buffer are played too."""
        return super().only_listed and not self.put_eval_levels_in_buffer
