"""README and documents show what params.yaml, the presets and the published results say."""

from pathlib import Path

import pytest

from industnerf.report.docs.documents import REFERENCE, generated_blocks, hyperparameters_page
from industnerf.report.docs.markdown_blocks import read_block

ROOT = Path(__file__).parents[2]
BLOCKS = [
    (document, name, content)
    for document, blocks in generated_blocks(ROOT).items()
    for name, content in blocks.items()
]


@pytest.mark.parametrize(
    ("document", "name", "content"), BLOCKS, ids=[f"{block[0].name}-{block[1]}" for block in BLOCKS]
)
def test_a_generated_block_is_up_to_date(document: Path, name: str, content: str):
    """If not: python -m industnerf.report.docs"""
    assert read_block((ROOT / document).read_text(encoding="utf-8"), name) == content


def test_the_list_of_parameters_is_up_to_date():
    """If not: python -m industnerf.report.docs"""
    text = (ROOT / REFERENCE / "hyperparameters.md").read_text(encoding="utf-8")
    assert text == hyperparameters_page(ROOT)
