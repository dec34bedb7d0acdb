"""The window's files: projects, recovery, recent files, preferences, pictures of views, the clipboard."""
