"""CAN links: raw frames over hardware, between processes or within one, and what they cost on the wire."""
