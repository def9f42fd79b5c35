# Exercise 2


def euler_eqs(t, w, I):
    (wx, wy, wz), (A, B, C) = w, I
    return (B - C) * wy * wz / A, (C - A) * wz * wx / B, (A - B) * wx * wy / C
