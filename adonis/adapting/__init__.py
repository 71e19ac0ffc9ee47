"""Adapting: a task made to suit another body, by the laws first and then by a small search."""
