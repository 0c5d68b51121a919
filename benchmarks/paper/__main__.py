from benchmarks.paper.report import main

main()
