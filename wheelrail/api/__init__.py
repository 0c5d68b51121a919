"""The classes behind `import wheelrail as wr`: pairs, wheelsets, runs, studies, and their tables and plots."""
