"""A population of users' situations, each judged by an oracle that shares no code with the contact models."""
