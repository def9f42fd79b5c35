"""polhode compared with other autograders: the same submission of exercise 2 and the same two checks, in one
run.

``python -m bench.peers`` installs each peer with pinned versions into its own environment below ``.bench``.
Each peer is a module here: the files it needs, the command that a course runs, and how to read its result.
"""
