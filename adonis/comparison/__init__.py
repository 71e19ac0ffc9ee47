"""A study: one task by several controllers, held against a paper and a human."""
