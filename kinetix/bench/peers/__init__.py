"""Other engines in the same scenes: their input, how they are run, and their results.

A peer lives in an environment of its own and is never imported here. It is given scenes as plain
JSON and answers with arrays or times; the judging is the same as our own engine's.
"""
