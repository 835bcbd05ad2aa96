"""Open levels: snapshots, commands, undo, files, copies of unsaved work."""
