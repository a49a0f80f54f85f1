"""The five axes: what they are built of, MuJoCo's model of it, and the closed loop that moves it."""
