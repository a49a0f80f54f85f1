"""Commands and forces that come late."""
