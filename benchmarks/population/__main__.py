"""A population of users' situations."""

from benchmarks.population.report import main

main()
