"""Assignments, a folder each, and in ``authoring`` what they are declared with and what follows from that."""
