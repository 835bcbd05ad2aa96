"""Reading of command lines, the same for every command and for the editor."""
