"""Actions on the level in front: edit it, by menus, by the pointer, by one-click fixes."""
