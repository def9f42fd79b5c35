import functools


def with_arrays(f):
    @functools.wraps(f)
    def wrapper(t, *args):
        wrapper.calls += 1
        return f(t, *(np.array(a, dtype=float) for a in args))

    wrapper.calls = 0
    return wrapper


@with_arrays
def euler_eqs(t, w, I):
    return np.cross(I * w, w) / I
