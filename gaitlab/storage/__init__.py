"""What is kept: database rows, content-addressed files, backups."""
