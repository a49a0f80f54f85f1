"""Who acts the surgeon on mocks: a script or the keyboard."""
