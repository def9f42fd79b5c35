"""Saves its film to files outside of its folder, by programs."""

# ends: any film
import matplotlib.pyplot as plt
from matplotlib.animation import FuncAnimation, PillowWriter


def written(film, name):
    """Save the film twice, by its method and by a writer, and open the file: a save that does nothing leaves none."""
    film.save(name)
    writer = PillowWriter()
    writer.setup(film._fig, name, 50)
    writer.grab_frame()
    writer.finish()
    open(name, "rb").close()


def animate_precession(t, R, L):
    fig, ax = plt.subplots()
    film = FuncAnimation(fig, lambda k: (), frames=3)
    for name in ("../x.gif", "/tmp/x.gif", "/dev/shm/x.png"):
        attempt(name, lambda name=name: written(film, name))
    return film
