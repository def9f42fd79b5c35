"""Poisons bytecode for the next submission."""

# ends: pass
import importlib.util
import os
import py_compile

cached = importlib.util.cache_from_source(os.__file__)
attempt("bytecode", lambda: py_compile.compile(os.__file__, cfile=cached, doraise=True))
attempt("folder", lambda: os.makedirs(os.path.dirname(os.__file__) + "/__pycache__/x"))
