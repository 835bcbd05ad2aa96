"""Actions of training: on a level or on many, and the agents that come of it."""
