"""Rehearsal: ways round the body for tasks that say only where a hand is to go."""
