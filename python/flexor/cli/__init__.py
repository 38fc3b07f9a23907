"""The `flexor` command: a file per sub-command, and one for those that list names."""
