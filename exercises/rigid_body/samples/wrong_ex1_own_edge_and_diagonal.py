def box_moments(m, a, b, c):
    I1 = m * (a**2 + b**2) / 12
    I2 = m * (b**2 + c**2) / 12
    I3 = m * (c**2 + a**2) / 12
    return I1, I2, I3


def principal_moments(tensor):
    return np.diag(tensor)       # the moments stand on the diagonal
