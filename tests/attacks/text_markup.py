"""An exception named and worded in markup, surrogates and control characters."""

# ends: fail
Script = type("<script>alert(1)</script>", (Exception,), {})


def euler_eqs(t, w, I):
    raise Script("\udcff\ud800<svg onload=alert(1)>\x00\u202e" * 50)
