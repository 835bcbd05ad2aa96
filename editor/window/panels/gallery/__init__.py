"""The page of the gallery: head, places, cards, side."""
