# no sympy here, so I wrote a very small one :)
class Expr:
    def __init__(self, f, text):
        self.f, self.text = f, text

    def __sub__(self, o): return Expr(lambda **v: self.f(**v) - o.f(**v), f"({self.text} - {o.text})")
    def __mul__(self, o): return Expr(lambda **v: self.f(**v) * o.f(**v), f"{self.text}*{o.text}")
    def __truediv__(self, o): return Expr(lambda **v: self.f(**v) / o.f(**v), f"{self.text}/{o.text}")
    def __call__(self, **values): return self.f(**values)
    def __repr__(self): return self.text


def symbols(names):
    return [Expr(lambda name=name, **v: v[name], name) for name in names.split()]


A, B, C, p, q, r = symbols("A B C p q r")
rhs = [(B - C) * q * r / A, (C - A) * r * p / B, (A - B) * p * q / C]
print("equations of motion:", rhs)


def euler_eqs(t, w, I):
    values = dict(zip("ABCpqr", [*I, *w]))
    return np.array([e(**values) for e in rhs])
