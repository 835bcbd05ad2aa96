"""Learning from what was played well: the teacher's data, and imitation of it."""
