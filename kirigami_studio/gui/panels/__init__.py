"""Groups of controls around the canvases: they show a document and report gestures; the controller decides."""
