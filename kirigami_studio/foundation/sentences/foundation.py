"""Sentences of the foundation: files and folders that cannot be used, and an incomplete installation."""

from __future__ import annotations

from kirigami_studio.foundation.words import mark

SENTENCES: dict[str, str | tuple[str, str]] = {
    "file.not_written": mark("Cannot write {path}: {reason}. Choose another folder or free some space."),
    "file.is_a_folder": mark("Cannot write {path}: it is a folder. Give a file name."),
    "file.link_to_nothing": mark(
        "Cannot write {path}: it is a link to {target}, which does not exist. Delete the link or choose another name."
    ),
    "file.link_in_circle": mark(
        "Cannot write {path}: the link leads back to itself. Delete it or choose another name."
    ),
    "file.folder_not_writable": mark("Cannot write to {folder}. Choose a folder where you have permission to write."),
    "installation.incomplete": mark("Bundled files are missing beside {package}. Install Kirigami Studio again."),
}
