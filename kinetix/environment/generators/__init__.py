"""Random levels, mutations of levels, and what is made from both."""
