"""Text by LaTeX, which reads files and runs programs."""

# ends: any film
import matplotlib.pyplot as plt
from matplotlib.animation import FuncAnimation


def animate_precession(t, R, L):
    plt.rcParams["text.usetex"] = True
    fig, ax = plt.subplots()
    ax.set_title(r"$\input{/etc/passwd}$")
    return FuncAnimation(fig, lambda k: (), frames=5)
