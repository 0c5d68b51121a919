"""Pictures of contacts, runs, tracks and studies."""
