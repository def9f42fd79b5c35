"""What an answer is judged by: checks, their words, and what ends the code that answers."""
