"""A player that plans: it tries many futures on the simulator itself and plays the best one."""
