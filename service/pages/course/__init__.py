"""The pages of the course: home, set-up, settings, and a student's page of an assignment."""
