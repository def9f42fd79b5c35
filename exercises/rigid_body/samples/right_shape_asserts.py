def euler_eqs(t, w, I):
    w = np.array(w, dtype=float)
    I = np.array(I, dtype=float)
    assert w.shape == (3,) and I.shape == (3,), "need three components"
    assert np.all(I > 0), "moments must be positive"
    wdot = np.cross(I * w, w) / I
    assert wdot.shape == (3,)
    # torque-free: no power
    assert abs(np.dot(I * w, wdot)) <= 1e-9 * (1 + np.sum(I * w**2) * np.linalg.norm(w))
    return wdot
