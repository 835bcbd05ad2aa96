"""Networks, checkpoints, agents that play, and their evaluation."""
