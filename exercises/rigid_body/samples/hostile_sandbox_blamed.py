import os

os.write(1, b"\0the sandbox failed")
os._exit(97)
