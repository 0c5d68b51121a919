from benchmarks.accuracy.report import main

main()
