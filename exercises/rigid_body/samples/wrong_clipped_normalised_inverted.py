def euler_eqs(t, w, I):
    speed = np.linalg.norm(w) or 1.0
    first = np.clip((I[1] - I[2]) * w[1] * w[2] / I[0], -5, 5)
    second = (I[2] - I[0]) * (w[2] / speed) * (w[0] / speed) / I[1]
    third = (1 / I[0] - 1 / I[1]) * w[0] * w[1] * I[2]
    return np.array([first, second, third])
