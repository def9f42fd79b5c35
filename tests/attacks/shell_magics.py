"""Magics that stand for those of the harness, and a module in place of IPython."""

# ends: pass
import sys
import types

shell = get_ipython()
for kind in ("line", "cell"):
    shell.magics_manager.magics[kind].clear()
shell._own.line = shell._own.cell = {}
sys.modules["IPython"] = sys.modules["guest.cells.shell"] = types.ModuleType("IPython")
