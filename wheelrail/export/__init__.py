"""The contact element of a wheelset for other programs: a C library with header, and functional mock-up units."""
