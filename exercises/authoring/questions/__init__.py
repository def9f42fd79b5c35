"""The former declaration: questions with their solutions in assignment.py."""
