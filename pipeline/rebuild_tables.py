"""Make tables and figures of a published study anew from its scores, after one was changed.

python -m pipeline.rebuild_tables results/study
python -m pipeline.rebuild_tables results/organic

No score is measured anew, and none changes; `made.json` says when and at which commit the tables
were made.  Pictures that need more than the scores stay as they are, and so does the goal about
what the reference rig sees; `python -m industnerf.report.docs` then brings the documents up to
date.  What is in mm is told by the parts as they are today: if these have another size than those
that were scored, nothing is written.
"""

import csv
import io
import os
from pathlib import Path

from industnerf.artifacts.files import write_json, write_text
from industnerf.cli import run_command
from industnerf.config import read_yaml
from industnerf.errors import BadArtifact
from industnerf.parts.catalogue.entries import read_catalogue, to_part
from industnerf.report.build import score_figures, table_texts
from industnerf.report.publish.provenance import commit_stamp, read_provenance
from industnerf.report.publish.published_results import read_published_results
from industnerf.report.publish.study_folder import readme_text
from industnerf.report.results import Results
from industnerf.report.tables.formats import read_csv


def main(published: str) -> None:
    folder = Path(published)
    results = rebuilt_results(folder)
    tables_by_name = table_texts(results)
    _check_part_sizes(folder, tables_by_name["table1.csv"])
    for name, text in tables_by_name.items():
        write_text(folder / name, text)
    for name, png in score_figures(results).items():
        (folder / name).write_bytes(png)
    provenance = read_provenance(folder) | {"rebuilt": _current_commit()}
    write_json(folder / "made.json", provenance)
    write_text(folder / "README.md", readme_text(folder, provenance))


def _check_part_sizes(published: Path, text: str) -> None:
    """Raise BadArtifact unless `text`, the new Table 1, has the old one's EMDs in mm."""
    published_emd = {_row_key(row): row.get("emd_mm") for row in read_csv(published / "table1.csv")}
    for row in csv.DictReader(io.StringIO(text)):
        published_value = published_emd.get(
            _row_key(row)
        )  # None in a table of before there were mm
        if published_value and published_value != row["emd_mm"]:
            raise BadArtifact(
                f"{published}: the mean EMD of {row['method']} was {published_value} mm, and the "
                f"same scores are {row['emd_mm']} mm today: the parts have another size than "
                "when they were scored. Run the study anew instead."
            )


def _row_key(row: dict[str, str]) -> tuple[str, str]:
    return row["method"], row["split"]


def _current_commit() -> dict[str, str]:
    provenance = commit_stamp()
    return {name: provenance[name] for name in ("date", "commit")}


def rebuilt_results(published: Path) -> Results:
    """What the tables in the folder `published` should say."""
    parts_path = Path(read_yaml(published / "params.yaml")["parts"]["path"])
    if ".." in parts_path.parts:  # of a preset, which ran in runs/<preset>
        parts_path = Path(os.path.normpath(Path("runs") / published.name / parts_path))
    return read_published_results(published, map(to_part, read_catalogue(parts_path)))


if __name__ == "__main__":
    run_command(main)
