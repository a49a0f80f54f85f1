"""`sher3 gap watch`: any robot that publishes its joint states, held against its model while it runs."""
