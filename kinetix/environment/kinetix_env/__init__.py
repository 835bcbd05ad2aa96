"""Names and fields of kinetix-env that states and environments answer to."""
