"""The target as the window's middle changes it: read, traced, sized, reshaped."""
