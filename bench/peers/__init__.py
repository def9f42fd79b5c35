"""polhode beside other autograders: the same submission of exercise 2, the same two checks, in one run on one machine.

``python -m bench.peers`` installs each peer with pinned versions into an environment of its own below ``.bench``. A peer is a
file here: where it wants its files, the command that a course types, and how its answer is read.
"""
