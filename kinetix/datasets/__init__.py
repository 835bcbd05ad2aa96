"""Recorded play as data: episodes of people, agents and the search, in shards on disk."""
