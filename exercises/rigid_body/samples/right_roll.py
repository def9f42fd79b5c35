import numpy


class Body:
    """Any callable will do, also one that prints."""

    def __call__(self, t, w, I):
        I = numpy.array(I, dtype=float)
        following, preceding = numpy.roll(I, -1), numpy.roll(I, 1)
        return ((following - preceding) * numpy.roll(w, -1) * numpy.roll(w, 1) / I).tolist()


euler_eqs = Body()
print("ready")
