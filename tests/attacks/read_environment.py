"""Its environment and arguments."""

# ends: pass
import os
import sys

if "".join(reversed(YRANAC)) in repr(dict(os.environ)) + repr(sys.argv) + repr(sys.orig_argv):
    print("ESCAPED")
if any(name.startswith(("POLHODE", "PG")) for name in os.environ):
    print("ESCAPED", sorted(os.environ))
