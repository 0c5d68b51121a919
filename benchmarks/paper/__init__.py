"""Tables 5 to 7 and Fig. 9 of the paper, reproduced."""
