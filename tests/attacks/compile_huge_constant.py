"""A constant expression that folding would make enormous."""

# ends: any
try:
    eval("(" * 190 + "'a' * 4096" + ")" * 190)
    compile("x = " + "+".join(["1"] * 200000), "x", "exec")
except (MemoryError, RecursionError, SyntaxError) as error:
    print(type(error).__name__)
