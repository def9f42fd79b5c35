def euler_eqs(t, w, I):
    I1, I2, I3 = I
    return np.array([(I2 - I3) * w[1] * w[2] / I1, (I3 - I1) * w[2] * w[0] / I2, (I1 - I2) * w[0] * w[1] / I3])


# %% the animation that this cell shows is the answer
I, t = (1.0, 1.0, 1.6), np.linspace(0, 8, 160)
w, R = integrate_body([0.5, 0.2, 3.0], I, t)
L = R[0] @ L_body(w[:, 0], I)
n = L / np.linalg.norm(L)
tips = R[:, :, 2]
fig = plt.figure()
ax = fig.add_subplot(projection="3d", xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1))
ax.plot([0, n[0]], [0, n[1]], [0, n[2]], "k")
(line,) = ax.plot([], [], [], "r")
anim = FuncAnimation(fig, lambda k: line.set_data_3d(*np.outer(tips[k], [0, 1])), frames=len(t))
plt.close(fig)
show(anim)

# %% another motion, with the same names
w, R = integrate_body([1.0, 0.6, 0.8], (2.0, 3.0, 4.0), t)
