"""The tables of the report: rows, and rows as CSV and Markdown."""
