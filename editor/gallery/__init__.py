"""The gallery's core: which levels there are, what they look like, which ones are wanted."""
