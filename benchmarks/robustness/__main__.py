from benchmarks.robustness.report import main

main()
