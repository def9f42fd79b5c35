# first try, energy was not conserved
def euler_eqs(t, w, I):
    return np.array([(I[1] - I[2]) * w[1] * w[2] / I[0],
                     (I[0] - I[2]) * w[2] * w[0] / I[1],
                     (I[0] - I[1]) * w[0] * w[1] / I[2]])


# second try: I3 - I1 in the middle
def euler_eqs(t, w, I):
    return np.array([(I[1] - I[2]) * w[1] * w[2] / I[0],
                     (I[2] - I[0]) * w[2] * w[0] / I[1],
                     (I[0] - I[1]) * w[0] * w[1] / I[2]])
