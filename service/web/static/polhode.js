// Our pages work without this.
