"""Contact models compared with closed forms, Kalker and CONTACT."""
