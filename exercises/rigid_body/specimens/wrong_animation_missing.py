def animate_precession(t, R, L):
    fig, ax = plt.subplots()
    ax.plot(t, R[:, 2, 2])
