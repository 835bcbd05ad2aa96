"""Speed against error: points, fronts, the two scalars of a class, and the picture."""
