"""Callbacks of IPython before and after each cell, which raise and print for ever."""

# ends: any
def raising(*info):
    raise SystemExit


for event in ("pre_execute", "pre_run_cell", "post_execute", "post_run_cell"):
    get_ipython().events.register(event, raising)


def euler_eqs(t, w, I):
    return w
