"""Actions of the gallery: choose levels, work on their files and sets."""
