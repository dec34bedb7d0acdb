"""Fields -> weights: data sets and training; the app never imports this package.

What training hands over is one safetensors file and its card.  May import everything below the GUI.
"""
