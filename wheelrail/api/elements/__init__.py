"""Contact elements with arguments by name, for time integrations outside of this package."""
