"""An animation whose every attribute is a trap."""


# ends: any film
class Film:
    def __getattr__(self, name):
        raise RuntimeError("</pre><script>" + name)


def animate_precession(t, R, L):
    return Film()
