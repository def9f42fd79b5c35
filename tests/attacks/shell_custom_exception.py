"""A handler of exceptions of IPython that swallows the end of its time, and a loop."""

# ends: pass slow
def swallow(shell, kind, value, trace, tb_offset=None):
    return []


get_ipython().set_custom_exc((BaseException,), swallow)
while True:
    try:
        while True:
            pass
    except BaseException:
        pass
