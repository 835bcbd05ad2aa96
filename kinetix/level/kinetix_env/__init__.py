"""kinetix-env's level format: read, checked, mended, made a level of ours, and written."""
