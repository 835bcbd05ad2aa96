"""Episodes and runs as self-contained web pages: play, scrub, speed, overlays, no network."""
