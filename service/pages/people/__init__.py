"""The pages of people: the list, one person, the roster, extensions, and the view as a student."""
