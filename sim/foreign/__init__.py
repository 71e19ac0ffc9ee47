"""Models that others made: reading them, finding their anatomy, making bodies of them."""
