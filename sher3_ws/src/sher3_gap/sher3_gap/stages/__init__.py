"""The robot's signal chain: residuals from each stage's measured input, floors, exact stages, the view of a run."""
