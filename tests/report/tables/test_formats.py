"""Tables come back as they were written."""

from industnerf.report.tables.formats import markdown_table, read_markdown_table


def test_a_table_for_people_is_read_back_without_what_stands_below_it(tmp_path):
    """Empty cells, at either end too, and a note."""
    path = tmp_path / "table.md"
    path.write_text(markdown_table(["a", "b", "c"], [["", "1", ""], ["2", "", "x"]]) + "\na note\n")
    assert read_markdown_table(path) == [
        {"a": "", "b": "1", "c": ""},
        {"a": "2", "b": "", "c": "x"},
    ]
