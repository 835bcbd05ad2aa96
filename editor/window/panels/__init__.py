"""The panels of the window: one file per panel."""
