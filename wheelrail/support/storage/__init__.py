"""Files: atomic writing, caches and their folder, plain data, text from outside."""
