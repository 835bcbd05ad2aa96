"""Headless training: PPO, and the curricula SFL, PLR, ACCEL and DR around it (docs/training.md)."""
