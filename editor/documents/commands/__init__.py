"""Edits of a level: one frozen command per kind of edit."""
