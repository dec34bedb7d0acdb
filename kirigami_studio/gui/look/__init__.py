"""How the window looks: palettes, icons, readable numbers, what the user prefers."""
