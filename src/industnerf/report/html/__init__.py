"""report.html: Jinja2 templates, and what they are given."""
