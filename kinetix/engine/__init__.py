"""The physics engine: rigid bodies in the plane, many worlds at once. See README.md in this folder."""
