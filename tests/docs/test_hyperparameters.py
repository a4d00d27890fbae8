"""docs/hyperparameters.md is what its command writes."""

from pathlib import Path

from industnerf.config import load_stages, read_yaml
from industnerf.report.hyperparameters.document import document


def test_the_document_is_up_to_date(root: Path):
    """If not: python -m industnerf.report.hyperparameters"""
    params = root / "params.yaml"
    wanted = document(params.read_text(), read_yaml(params), load_stages(root / "dvc.yaml"))
    assert (root / "docs/hyperparameters.md").read_text() == wanted
