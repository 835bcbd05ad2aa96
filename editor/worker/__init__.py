"""Work beside the window: jobs, their requests and the one bridge to JAX."""
