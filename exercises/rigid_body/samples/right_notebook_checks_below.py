def euler_eqs(t, w, I):
    I = np.asarray(I, dtype=float)
    return -np.cross(w, I * w) / I


I0 = (2.0, 3.0, 4.0)
t = np.linspace(0, 20, 900)
w, R = integrate_body((1.0, 0.6, 0.8), I0, t)
validate.conserved(T_rot(w, I0), "rotational energy conserved (torque-free)")
validate.conserved(np.linalg.norm(L_body(w, I0), axis=0), "|L| conserved")
sol = solve_ivp(euler_eqs, (0, 5), [1.0, 0.6, 0.8], args=(I0,), rtol=1e-9)
print("steps:", sol.t.size, " T =", T_rot(w, I0)[0])
plt.plot(t, w.T)
plt.xlabel("t")
plt.show()
