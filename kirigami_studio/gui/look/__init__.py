"""How the window looks: palettes, icons, readable numbers, preferences."""
