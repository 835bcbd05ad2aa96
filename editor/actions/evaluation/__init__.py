"""Actions of evaluations: measure agents, compare them, keep the table."""
