"""What happens when something breaks: faults to inject, and how far the tip travels before it stands."""
