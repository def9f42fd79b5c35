"""Poisons matplotlib's cache and settings for the next submission."""

# ends: pass
import matplotlib

cache, settings = matplotlib.get_cachedir(), matplotlib.get_configdir()
attempt("font list", lambda: open(cache + "/fontlist-v390.json", "w"))
attempt("settings", lambda: open(settings + "/matplotlibrc", "w"))
attempt("new file", lambda: open(cache + "/stylelib", "w"))
