def euler_eqs(t, w, I):
    dwdt = np.zeros(3)
    dwdt[0] += I[1] * w[1] * w[2]
    dwdt[0] -= I[2] * w[1] * w[2]
    dwdt[1] += I[2] * w[2] * w[0]
    dwdt[1] -= I[0] * w[2] * w[0]
    dwdt[2] += I[0] * w[0] * w[1]
    dwdt[2] -= I[1] * w[0] * w[1]
    dwdt /= I
    return dwdt
