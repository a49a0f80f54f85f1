"""Servos of joints: what they give against what their law asks for."""
