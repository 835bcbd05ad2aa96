"""Measurements: speed, rendering, accuracy. One file a command."""
