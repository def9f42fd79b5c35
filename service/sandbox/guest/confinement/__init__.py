"""What confines a child: system calls, files, users, its scratch folder and its limits."""
