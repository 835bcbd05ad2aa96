"""Actions of files: open, save, export, record, recover, quit."""
