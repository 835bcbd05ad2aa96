"""Other engines in the same scenes: what they are told, how they are run, what is made of it.

A peer lives in an environment of its own and is never imported here. It is told scenes as plain
JSON and answers with arrays or times; the judging is the same as our own engine's.
"""
