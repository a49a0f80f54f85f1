"""A serial arm as a machine of the diagnosis: its geometry, judged by poses measured from outside."""
