"""An exception whose text never ends."""


# ends: fail slow
class Loop(Exception):
    def __str__(self):
        while True:
            pass

    __repr__ = __str__


def euler_eqs(t, w, I):
    raise Loop
