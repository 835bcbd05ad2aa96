"""The app in a browser: drawn offscreen here, shown and used on a page elsewhere."""
