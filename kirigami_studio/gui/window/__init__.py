"""The main window: places put together, menus and commands, dialogs that belong to no place, start and end."""
