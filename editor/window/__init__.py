"""The window: panels, canvas, dialogs, layouts and the one frame function."""
