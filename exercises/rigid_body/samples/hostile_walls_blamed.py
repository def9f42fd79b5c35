import os

os.write(1, b"\0the walls fell")
os._exit(97)
