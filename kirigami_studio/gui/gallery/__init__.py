"""The designs of the open project as cards and as a table: chosen, compared, named, pinned, rejected."""
