"""The doors of files: bytes, text, YAML and JSON (`text`), arrays (`arrays`)."""
