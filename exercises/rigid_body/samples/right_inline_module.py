# I keep my own toolbox; normally it is a file next to the notebook
import sys
import types

source = '''
def cross(a, b):
    return (a[1]*b[2] - a[2]*b[1],
            a[2]*b[0] - a[0]*b[2],
            a[0]*b[1] - a[1]*b[0])

def scale(a, b):
    return tuple(x*y for x, y in zip(a, b))
'''
vectools = types.ModuleType("vectools")
exec(source, vectools.__dict__)
sys.modules["vectools"] = vectools

from vectools import cross, scale


def euler_eqs(t, w, I):
    L = scale(I, w)
    n = cross(L, w)
    return [n[0] / I[0], n[1] / I[1], n[2] / I[2]]
