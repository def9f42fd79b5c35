"""A film without an end."""

# ends: any film
import itertools

import matplotlib.pyplot as plt
from matplotlib.animation import FuncAnimation


def animate_precession(t, R, L):
    fig, ax = plt.subplots()
    return FuncAnimation(fig, lambda k: (), frames=itertools.count(), cache_frame_data=False)
