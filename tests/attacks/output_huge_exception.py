"""An exception with a message of 150 megabytes."""

# ends: fail
raise ValueError("<b>" * (50 << 20))
