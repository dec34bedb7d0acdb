"""How the chosen design is made: material, connectors, the cut plan on screen, the verdict, and its files."""
