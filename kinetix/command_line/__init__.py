"""How the words of a command line are read, the same for every command and for the editor."""
