"""Showing an animation as a player."""

from polhode.animation.animate import show

__all__ = ["show"]
