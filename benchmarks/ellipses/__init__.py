"""Random ellipses that roll, on strips of half-spaces: failed solves, and errors against cells twice as fine."""
