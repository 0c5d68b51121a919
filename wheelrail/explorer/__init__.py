"""Explorer of contacts and of runs in a browser: what is moved on the page is solved and drawn again at once."""
