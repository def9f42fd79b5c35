def box_moments(m, a, b, c):
    """Full edges a, b, c."""
    sq = np.array([a, b, c], dtype=float) ** 2
    return m / 12 * (sq.sum() - sq)


def principal_moments(tensor):
    """Jacobi rotations, as in the numerics lecture, no linalg."""
    A = np.array(tensor, dtype=float)
    for sweep in range(30):
        for p, q in ((0, 1), (0, 2), (1, 2)):
            if A[p, q] == 0.0:
                continue
            phi = 0.5 * np.arctan2(2 * A[p, q], A[q, q] - A[p, p])
            J = np.eye(3)
            J[p, p] = J[q, q] = np.cos(phi)
            J[p, q], J[q, p] = np.sin(phi), -np.sin(phi)
            A = J.T @ A @ J
    return sorted((float(x) for x in A.diagonal()), reverse=True)
