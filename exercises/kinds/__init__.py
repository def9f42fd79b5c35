"""The kinds of questions that an author's ``assignment.py`` may ask, a module each."""
