"""Drawing the level and everything that lies over it as vectors."""
