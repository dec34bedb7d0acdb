"""What asks: file choosers, the library, the guide.  Dialogs ask, the controller does."""
