"""A trace function that changes what the harness sees."""

# ends: any
import sys


def tamper(frame, event, arg):
    frame.f_locals.clear()
    return tamper


sys.settrace(tamper)
sys.setprofile(lambda *a: None)
