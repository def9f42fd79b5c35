"""Changes its arguments to disturb its caller."""


# ends: fail
def euler_eqs(t, w, I):
    w[:] = 0
    I[:] = 1
    return w
