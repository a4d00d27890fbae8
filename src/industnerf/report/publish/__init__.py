"""Results that are committed: their provenance, copying, and reading back."""
