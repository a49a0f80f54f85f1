"""What the force sensor reads, or an axis feels, beside the contact."""
