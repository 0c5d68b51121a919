from benchmarks.wear.report import main

main()
