"""Actions of watching agents: let them play, and views beside the episode."""
