from benchmarks.ellipses.report import main

main()
