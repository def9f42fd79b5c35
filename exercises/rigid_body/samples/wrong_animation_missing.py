def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    fig, ax = plt.subplots()
    ax.plot(t, R[:, 2, 2])
