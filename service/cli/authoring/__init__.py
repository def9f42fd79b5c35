"""Commands for the authors of assignments."""
