"""Names of the files that a run writes."""

RESULTS, CHECKPOINTS = "run.nc", "run.checkpoints"
