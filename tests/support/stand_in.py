"""Modules that stand in for numpy and scipy where there are none: the kit can be imported and can submit, but
not check.
"""

import importlib.abc
import importlib.machinery
import sys
import types


class Anything(types.ModuleType):
    """Each attribute, item, result of a call or an operator of it is one too.
    Nothing is an instance of it.
    """

    __path__, files = (), ()

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return Anything(name)

    def __call__(self, *arguments, **named):
        return Anything("result")

    __getitem__ = __or__ = __ror__ = __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = (
        __truediv__
    ) = __call__
    __rtruediv__ = __pow__ = __rpow__ = __neg__ = __lt__ = __le__ = __gt__ = __ge__ = __enter__ = __call__

    def __exit__(self, *error):
        return None

    def __iter__(self):
        return iter(())

    def __len__(self):
        return 1

    def __float__(self):
        return 0.0

    def __instancecheck__(self, instance):
        return False

    def __mro_entries__(self, bases):
        return ()


class Finder(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Finds every module of numpy and scipy."""

    def find_spec(self, name, path=None, target=None):
        return (
            importlib.machinery.ModuleSpec(name, self) if name.split(".")[0] in ("numpy", "scipy") else None
        )

    def create_module(self, spec):
        return Anything(spec.name)

    def exec_module(self, module):
        pass


sys.meta_path.append(Finder())
