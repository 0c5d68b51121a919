"""What several benchmarks share: machine, models, reference tables, measurements."""
