from benchmarks.error_vs_time.report import main

main()
