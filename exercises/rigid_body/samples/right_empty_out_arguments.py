def euler_eqs(t, w, I):
    L = np.multiply(I, w)
    out = np.empty(3)
    out[:] = np.cross(L, w)
    np.divide(out, I, out=out)
    return out
