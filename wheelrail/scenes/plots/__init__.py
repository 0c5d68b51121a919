"""2D figures of contacts and runs, drawn from Datasets by Matplotlib."""
