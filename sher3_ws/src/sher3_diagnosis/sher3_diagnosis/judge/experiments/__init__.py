"""What would settle a verdict: runs that were never made, foretold with each rival at work."""
