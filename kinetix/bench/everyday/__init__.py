"""Everyday scenes in our engine and in others: how often something goes wrong."""
