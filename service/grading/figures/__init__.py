"""Pictures and data of graded submissions: figures, charts of speed, animated motions."""
