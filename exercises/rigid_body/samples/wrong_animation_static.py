def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    fig, ax = plt.subplots()
    ax.plot(R[:, 0, 2], R[:, 1, 2])
    return FuncAnimation(fig, lambda k: (), frames=len(t))
