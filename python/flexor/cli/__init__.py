"""The `flexor` command: one file per sub-command, registered in `app.py`."""
