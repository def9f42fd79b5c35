"""Hooks of the collector, of audits and of faults."""

# ends: any
import faulthandler
import gc
import sys

gc.callbacks.append(lambda *a: None)
gc.set_threshold(1)
sys.addaudithook(lambda event, args: None)
try:
    faulthandler.dump_traceback_later(0.01, repeat=True)
except RuntimeError as error:
    print(error)
