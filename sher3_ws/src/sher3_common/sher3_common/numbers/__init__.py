"""What is computed of plain numbers in several rooms: how sure a share is, what is smooth in a signal."""
