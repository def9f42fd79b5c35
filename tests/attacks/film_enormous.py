"""A figure of a thousand million pixels that will not be resized."""

# ends: any film
import matplotlib.pyplot as plt
from matplotlib.animation import FuncAnimation


def animate_precession(t, R, L):
    fig = plt.figure(figsize=(1e5, 1e5), dpi=1e4)
    fig.set_size_inches = fig.set_dpi = lambda *a: None
    return FuncAnimation(fig, lambda k: (), frames=5)
