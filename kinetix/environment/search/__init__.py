"""The search for plans that win a level, behind `kinetix solve`."""
