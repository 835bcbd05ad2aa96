"""Actions of play: start and stop, go back, keep a win, choose the physics."""
