"""Editing on the canvas: tools, picking, snapping."""
