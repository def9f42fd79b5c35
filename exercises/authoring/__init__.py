"""What an author writes an assignment with."""
