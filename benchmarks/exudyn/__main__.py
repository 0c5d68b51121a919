from benchmarks.exudyn.report import main

main()
