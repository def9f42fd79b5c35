def euler_eqs(t, w, I):
    I1, I2, I3 = I
    w1, w2, w3 = w
    return np.array([(I2 - I3) * w2 * w3 / I1, (I3 - I1) * w3 * w1 / I2, (I1 - I2) * w1 * w2 / I3])


def precession_rate(t, w):
    phase = np.arctan2(w[1], w[0])
    slope, offset = np.polyfit(t, phase, 1)
    return slope
