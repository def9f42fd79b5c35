"""Coupled oscillators: normal modes, beats, waves on a chain."""
