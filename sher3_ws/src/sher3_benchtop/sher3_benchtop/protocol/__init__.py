"""The paper's five tests as tables of commands and loads."""
