"""Make the tables of a published study anew from its scores, after a table got a column.

python -m pipeline.retable results/study
python -m pipeline.retable results/organic

No score is measured anew, and none changes; `made.json` says when and at which commit the tables
were made.  Pictures, which need more than the scores, stay as they are, and so does the goal about
what the reference rig sees; `python -m pipeline.publish readme` then brings the documents up to
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
from industnerf.parts.catalogue import catalogue
from industnerf.parts.embedded import as_part
from industnerf.report.build import table_texts
from industnerf.report.formats import csv_rows
from industnerf.report.provenance import origin, read_made
from industnerf.report.publish import about
from industnerf.report.reread import reread_study


def main(published: str) -> None:
    folder = Path(published)
    texts = tables(folder)
    _refuse_other_parts(folder, texts["table1.csv"])
    for name, text in texts.items():
        write_text(folder / name, text)
    made = read_made(folder) | {"retabled": _now()}
    write_json(folder / "made.json", made)
    write_text(folder / "README.md", about(folder, made))


def _refuse_other_parts(published: Path, text: str) -> None:
    """Raise BadArtifact unless `text`, the new Table 1, has the old one's EMDs in mm."""
    known = {_row(row): row.get("emd_mm") for row in csv_rows(published / "table1.csv")}
    for row in csv.DictReader(io.StringIO(text)):
        before = known.get(_row(row))  # None in a table of before there were mm
        if before and before != row["emd_mm"]:
            raise BadArtifact(
                f"{published}: the mean EMD of {row['method']} was {before} mm, and the same "
                f"scores are {row['emd_mm']} mm today: the parts have another size than when they "
                "were scored. Run the study anew instead."
            )


def _row(row: dict[str, str]) -> tuple[str, str]:
    return row["method"], row["split"]


def _now() -> dict[str, str]:
    found = origin()
    return {name: found[name] for name in ("date", "commit")}


def tables(published: Path) -> dict[str, str]:
    """What the tables in the folder `published` should say, by the name of the file."""
    place = Path(read_yaml(published / "params.yaml")["parts"]["path"])
    if ".." in place.parts:  # of a preset, which ran in runs/<preset>
        place = Path(os.path.normpath(Path("runs") / published.name / place))
    return table_texts(reread_study(published, map(as_part, catalogue(place))))


if __name__ == "__main__":
    run_command(main)
