"""The commands `safety`, `safety budget` and `fault`; their bodies are imported when they are called."""
