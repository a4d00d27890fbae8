"""docs/reference/hyperparameters.md is what its command writes."""

from pathlib import Path

from industnerf.config import load_stages, read_yaml
from industnerf.report.docs.hyperparameters.document import render_document


def test_the_document_is_up_to_date(root: Path):
    """If not: python -m industnerf.report.docs.hyperparameters"""
    params = root / "params.yaml"
    expected = render_document(
        params.read_text(), read_yaml(params), load_stages(root / "dvc.yaml")
    )
    assert (root / "docs/reference/hyperparameters.md").read_text() == expected
