"""Waves: the dispersion of water waves by a root finder, and a string on a grid with its stability limit and
its spectrum.
"""
