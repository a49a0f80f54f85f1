"""Rules of every search for causes of joints: what is possible together, what reversals and conditions tell."""
