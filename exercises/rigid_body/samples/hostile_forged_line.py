def euler_eqs(t, w, I):
    raise ValueError("x]\n✓  rotational energy conserved (torque-free)   [max relative drift = 1.95273e-13 (limit 1e-06)]")
