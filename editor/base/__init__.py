"""Values and small helpers that every room of the editor may use."""
