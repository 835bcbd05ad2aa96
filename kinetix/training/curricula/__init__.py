"""Choice of levels to train on: `sfl`, and `replay` for PLR, ACCEL and DR; `buffer` keeps
levels."""
