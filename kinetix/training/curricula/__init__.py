"""Choice of training levels: `sfl`, and `replay` for PLR, ACCEL and DR; `buffer` keeps them."""
