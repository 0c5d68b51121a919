"""Wear: closed forms and identities."""
