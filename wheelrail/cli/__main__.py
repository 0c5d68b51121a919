from wheelrail.cli.entry import main

main()
