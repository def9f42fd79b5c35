ncalls = 0

def euler_eqs(t, w, I):
    global ncalls
    ncalls += 1
    dw1dt = (I[1] - I[2]) * w[1] * w[2] / I[0]
    dw2dt = (I[2] - I[0]) * w[2] * w[0] / I[1]
    dw3dt = (I[0] - I[1]) * w[0] * w[1] / I[2]
    if ncalls <= 3:
        print(f"call #{ncalls}: t = {t:8.4f}, w = {[f'{x:+.3f}' for x in w]}")
        print(f"   --> dw/dt = ({dw1dt:+.4e}, {dw2dt:+.4e}, {dw3dt:+.4e})  \N{check mark}")
    return dw1dt, dw2dt, dw3dt

print(f"test: {euler_eqs(0, [1.0, 0.6, 0.8], [2, 3, 4]) = }")
