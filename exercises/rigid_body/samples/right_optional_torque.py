def euler_eqs(t, w, I, N=lambda t: (0.0, 0.0, 0.0), **kwargs):
    """General Euler equations; the torque N(t) is zero unless somebody gives one (Ex 2: torque-free)."""
    assert len(w) == 3 and len(I) == 3, "need three components"
    N1, N2, N3 = N(t)
    wx, wy, wz = w
    Ix, Iy, Iz = I
    return np.array([
        (N1 + Iy * wy * wz - Iz * wz * wy) / Ix,
        (N2 + Iz * wz * wx - Ix * wx * wz) / Iy,
        (N3 + Ix * wx * wy - Iy * wy * wx) / Iz,
    ])
