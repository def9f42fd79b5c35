"""The questions: files here are the grammar, each folder is an assignment. A new assignment is a new folder; nothing lists them."""
