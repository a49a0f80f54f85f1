"""What a run tells: rates and gaps, tracking, comparison of two runs, pictures, the report."""
