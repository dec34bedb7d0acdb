"""Files as the window's middle knows them: projects, recovery, recent files, pictures, the clipboard."""
