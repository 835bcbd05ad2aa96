"""The modules and names of kinetix-env, over what this package has. Nothing else here knows it.

`names` is the table of all of them, `finder` makes modules of it, and the other files adapt what
has another form here. Names of kinetix-env 0.x and 1.x warn once and work.
"""
