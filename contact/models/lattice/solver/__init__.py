"""Solution of the contact on a lattice: cold start, Newton's method, strips that enter and leave, kept factors."""
