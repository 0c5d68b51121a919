"""Common parts of the benchmarks: machine, models, reference tables, measurements."""
