"""An exported model run in MuJoCo on the recorded commands: what is left of the gap proves that the numbers act."""
