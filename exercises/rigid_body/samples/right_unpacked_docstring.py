def euler_eqs(t, w, I):
    r"""Torque-free Euler equations in the body frame.

    .. math:: I_1 \dot\omega_1 = (I_2 - I_3)\,\omega_2\omega_3  \quad\text{(cyclic)}
    """
    w1, w2, w3 = w
    I1, I2, I3 = I
    wdot1 = (I2 - I3) / I1 * w2 * w3
    wdot2 = (I3 - I1) / I2 * w3 * w1
    wdot3 = (I1 - I2) / I3 * w1 * w2
    return np.array([wdot1, wdot2, wdot3])
