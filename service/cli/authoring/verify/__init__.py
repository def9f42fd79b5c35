"""The command `polhode verify`: samples graded and compared with what they should get."""
