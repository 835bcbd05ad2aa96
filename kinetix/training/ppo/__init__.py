"""PPO: `losses`, `rollout`, `update` are its parts, `train` is the loop."""
