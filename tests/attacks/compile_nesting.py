"""A source in its source that makes the compiler recurse."""

# ends: pass
try:
    exec("x = " + "-" * 100000 + "1")
except (MemoryError, RecursionError, SyntaxError) as error:
    print(type(error).__name__)
