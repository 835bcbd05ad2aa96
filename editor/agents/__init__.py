"""Watching agents: players, evaluations, training runs, results."""
