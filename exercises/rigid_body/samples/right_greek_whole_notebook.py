# %% Exercice 2
def euler_eqs(t, ω, I):
    ω1, ω2, ω3 = ω
    A, B, C = I
    dω1 = (B - C) / A * ω2 * ω3
    dω2 = (C - A) / B * ω3 * ω1
    dω3 = (A - B) / C * ω1 * ω2
    return np.array([dω1, dω2, dω3])

# %% on intègre
I = np.array([2.0, 3.0, 4.0])
ω0 = np.array([1.0, 0.6, 0.8])
sol = solve_ivp(euler_eqs, (0, 20), ω0, args=(I,), rtol=1e-10, atol=1e-12, dense_output=True)
t = np.linspace(0, 20, 400)
ω = sol.sol(t)

# %% Exercice 3 : énergie et moment cinétique
T = T_rot(ω, I)
Lnorm = np.linalg.norm(L_body(ω, I), axis=0)
print("dérive T :", np.ptp(T) / T[0], " dérive |L| :", np.ptp(Lnorm) / Lnorm[0])
plt.plot(t, ω.T)
plt.legend(["ω1", "ω2", "ω3"])
plt.show()
