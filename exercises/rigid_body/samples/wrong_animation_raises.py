def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    fig, ax = plt.subplots()
    (line,) = ax.plot([], [])

    def update(k):
        line.set_data(R[k, 0, 3], R[k, 1, 3])

    return FuncAnimation(fig, update, frames=len(t))
