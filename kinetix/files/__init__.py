"""Bounded reading of files that others wrote: nothing in them costs much time or memory."""
