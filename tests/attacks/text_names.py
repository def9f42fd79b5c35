"""A function that says it stands in another file."""


# ends: fail
def euler_eqs(t, w, I):
    1 / 0


euler_eqs.__code__ = euler_eqs.__code__.replace(co_name="</pre><script>x</script>", co_filename="/etc/passwd")
