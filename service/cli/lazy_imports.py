"""Modules that SciPy imports by ``from numpy import *`` and does not use: they take a third of the time of
importing scipy.special.

Not for guests: a submission may use them where it may read no files.
"""

import importlib.util
import sys

UNUSED = ("numpy.f2py", "numpy.testing")


def import_lazily() -> None:
    """Import ``UNUSED`` so that each module is executed at the first use of one of its names."""
    for name in UNUSED:
        spec = importlib.util.find_spec(name)
        if name in sys.modules or spec is None or spec.loader is None:
            continue
        spec.loader = loader = importlib.util.LazyLoader(spec.loader)
        module = sys.modules[name] = importlib.util.module_from_spec(spec)
        loader.exec_module(module)
        parent, _, child = name.rpartition(".")
        setattr(sys.modules[parent], child, module)
