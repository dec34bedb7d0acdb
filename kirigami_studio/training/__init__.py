"""Fields -> weights: data sets and training, beside the app, which never imports this room.

What training hands over is one safetensors file and its card.  May import everything below the GUI.
"""
