def euler_eqs(t, w, I):
    """Body rates (roll p, pitch q, yaw r) of an aircraft without aerodynamic moments.

    Etkin: A p' - (B - C) q r = 0 and so on.
    """
    p, q, r = w
    A, B, C = I
    p_dot = -q * r * (C - B) / A
    q_dot = -r * p * (A - C) / B
    r_dot = -p * q * (B - A) / C
    return np.hstack((p_dot, q_dot, r_dot))
