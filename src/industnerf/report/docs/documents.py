"""Everything in README.md and docs/ that is generated, and what it is generated from."""

from pathlib import Path

from industnerf.artifacts.files import write_text
from industnerf.config import PARAMS, load_stages, read_yaml
from industnerf.report.docs.claims import claims_block
from industnerf.report.docs.costs import cluster_block, costs_block
from industnerf.report.docs.hyperparameters.document import render_document
from industnerf.report.docs.learned_methods import leakage_block, networks_block
from industnerf.report.docs.markdown_blocks import write_blocks
from industnerf.report.docs.protocol_readings import protocol_block
from industnerf.report.docs.study_results import readme_block, results_block
from industnerf.report.docs.summary import copy_figures, summary_block
from industnerf.report.sweeps.preset_table import PUBLISHED, sweep_table

SUMMARY = Path("docs/results.md")
README, REFERENCE, RESULTS = Path("README.md"), Path("docs/reference"), Path("docs/results")
STUDY, DEMO, GRID = (Path("results") / name for name in ("study", "demo", "grid"))
LEAKAGE = PUBLISHED / "leakage"


def generated_blocks(root: Path) -> dict[Path, dict[str, str]]:
    """Document -> name of a block -> its content, of the published results below `root`.

    A document has no entry while its results are not published.  Raises BadArtifact if
    published results cannot be read.
    """
    study, demo, grid, leakage = (root / path for path in (STUDY, DEMO, GRID, LEAKAGE))
    blocks: dict[Path, dict[str, str]] = {REFERENCE / "sweeps.md": {"sweeps": sweep_table(root)}}
    if demo.exists():
        blocks[RESULTS / "demo.md"] = {"demo": results_block(demo)}
    if study.exists():
        blocks[README] = {"study": readme_block(study, root / PARAMS)}
        blocks[RESULTS / "study.md"] = {
            "study": results_block(study, root / PARAMS, with_paper_tables=True)
        }
        blocks[SUMMARY] = {"summary": summary_block(study)}
        blocks[RESULTS / "claims.md"] = {"claims": claims_block(study, root / PUBLISHED)}
        blocks[REFERENCE / "scaling.md"] = {
            "costs": costs_block(study),
            "cluster": cluster_block(study),
        }
        learned = {"leakage": leakage_block(leakage, study)} if leakage.exists() else {}
        blocks[REFERENCE / "baselines.md"] = {"nets": networks_block(study), **learned}
        if grid.exists():
            blocks[REFERENCE / "readings.md"] = {"measuring": protocol_block(study, grid)}
    return blocks


def hyperparameters_page(root: Path) -> str:
    """All of docs/reference/hyperparameters.md."""
    params = root / PARAMS
    return render_document(
        params.read_text(encoding="utf-8"), read_yaml(params), load_stages(root / "dvc.yaml")
    )


def write_documents(root: Path) -> list[Path]:
    """Bring README and documents up to date; returns those that have a generated part.

    Raises BadArtifact if a document lacks the comments around a block.
    """
    blocks = generated_blocks(root)
    for document, contents in blocks.items():
        write_blocks(root / document, contents)
    copy_figures(root / STUDY, root / RESULTS)
    write_text(root / REFERENCE / "hyperparameters.md", hyperparameters_page(root))
    return [*blocks, REFERENCE / "hyperparameters.md"]
