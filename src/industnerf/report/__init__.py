"""From scores to tables, pictures and one page."""
