"""Blocks of documents are replaced where their comments are."""

import pytest

from industnerf.errors import BadArtifact
from industnerf.report.docs.markdown_blocks import read_block, replace_block, write_blocks


def test_a_block_is_put_where_its_comments_are():
    text = "a\n<!-- study -->\nold\n<!-- end study -->\nb\n<!-- demo -->\n<!-- end demo -->\n"
    new = replace_block(text, "study", "new \\1\n")
    assert new == text.replace("old", "new \\1")
    assert (read_block(new, "study"), read_block(new, "demo")) == ("new \\1\n", "")


def test_blocks_of_a_file_are_replaced_and_the_rest_is_kept(tmp_path):
    path = tmp_path / "page.md"
    path.write_text("<!-- a -->\n<!-- end a -->\ntext\n<!-- b -->\nold\n<!-- end b -->\n")
    write_blocks(path, {"a": "1\n", "b": "2\n"})
    assert (
        path.read_text() == "<!-- a -->\n1\n<!-- end a -->\ntext\n<!-- b -->\n2\n<!-- end b -->\n"
    )


@pytest.mark.parametrize(
    "text", ["no marks", "<!-- study -->\nx", 2 * "<!-- study -->\n<!-- end study -->\n"]
)
def test_missing_or_double_comments_are_refused(text):
    with pytest.raises(BadArtifact, match="one place between <!-- study --> and"):
        replace_block(text, "study", "new")
