# write the formula once as text, let python fill in the indices
template = "(I[{j}] - I[{k}]) / I[{i}] * w[{j}] * w[{k}]"
cyclic = ["012", "120", "201"]
formulas = [template.format(i=s[0], j=s[1], k=s[2]) for s in cyclic]
code = compile("[" + ", ".join(formulas) + "]", "<euler>", "eval")
print("\n".join(f"dw{n + 1}/dt = {f}" for n, f in enumerate(formulas)))


def euler_eqs(t, w, I):
    return np.array(eval(code, {"w": w, "I": I}))
