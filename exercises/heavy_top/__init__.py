"""The heavy symmetric top, and two free tops."""
