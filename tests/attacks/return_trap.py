"""Objects that never become numbers."""


# ends: fail slow
class Trap:
    def __float__(self):
        while True:
            pass

    __index__ = __array__ = __float__


def euler_eqs(t, w, I):
    return [Trap(), Trap(), Trap()]
