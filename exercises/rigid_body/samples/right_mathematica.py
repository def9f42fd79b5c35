# Mathematica habits: RotateLeft[list] and everything elementwise
RotateLeft = lambda lst, n=1: np.roll(np.asarray(lst, dtype=float), -n)
Times = lambda *factors: np.prod(np.stack(factors), axis=0)
Subtract = np.subtract
Divide = np.divide

euler_eqs = lambda t, w, I: Divide(
    Times(Subtract(RotateLeft(I), RotateLeft(I, 2)), RotateLeft(w), RotateLeft(w, 2)),
    np.asarray(I, dtype=float),
)
