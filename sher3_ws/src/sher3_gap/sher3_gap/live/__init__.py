"""The diagnosis beside the running robot."""
