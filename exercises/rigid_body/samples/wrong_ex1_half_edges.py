def box_moments(m, a, b, c):
    # half edges a, b, c  ->  m/3
    return np.array([m / 3 * (b**2 + c**2), m / 3 * (c**2 + a**2), m / 3 * (a**2 + b**2)])


def principal_moments(tensor):
    return np.linalg.eigvalsh(tensor)
