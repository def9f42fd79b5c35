# SUBROUTINE EULER(T, W, XI, DW), arrays start at 1
def subroutine_euler(t, w, xi, dw):
    dw[1] = (xi[2] - xi[3]) * w[2] * w[3]
    dw[2] = (xi[3] - xi[1]) * w[3] * w[1]
    dw[3] = (xi[1] - xi[2]) * w[1] * w[2]
    for n in range(1, 3 + 1):
        dw[n] = dw[n] / xi[n]


def euler_eqs(t, w, I):
    dw = np.empty(4)
    subroutine_euler(t, [None, *w], [None, *I], dw)
    return dw[1:]
