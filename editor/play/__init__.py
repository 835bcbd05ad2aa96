"""Playing a level: states, the clock, keys, recorded episodes."""
