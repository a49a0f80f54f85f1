"""What holds for any chain of joints, an axis being a chain of one."""
