from benchmarks.stability.report import main

main()
