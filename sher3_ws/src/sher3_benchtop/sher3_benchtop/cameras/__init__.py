"""The two cameras of the bench and the pictures they take."""
