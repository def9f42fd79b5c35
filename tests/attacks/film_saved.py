"""Saves its film to files, by programs."""

# ends: any film
import matplotlib.pyplot as plt
from matplotlib.animation import FuncAnimation


def animate_precession(t, R, L):
    fig, ax = plt.subplots()
    film = FuncAnimation(fig, lambda k: (), frames=3)
    for name in ("x.mp4", "/tmp/x.gif", "x.html"):
        attempt(name, lambda name=name: film.save(name))
    return film
