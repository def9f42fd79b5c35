def euler_eqs(t, w, I):
    match np.ndim(I):
        case 1:
            J = np.diag(I)
        case 2:
            J = np.asarray(I)
        case _:
            raise ValueError("I must be (3,) or (3, 3)")
    return -np.linalg.solve(J, np.cross(w, J @ w))
