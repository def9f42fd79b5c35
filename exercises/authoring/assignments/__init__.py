"""Assignments as they are graded: declared, found in folders, valid, with samples and packages."""
