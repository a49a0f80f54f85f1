"""The truth plant on MuJoCo: sliders, riders, tendons and springs as bodies, moved by its contacts and its solver.

An axis is a body on a joint. What is wrong with it is built, not written as a law: a gap is a tendon with a limited
length, gradual lost motion and cables are springs that drag a body over rough ground, a payload is a body with weight.
"""
