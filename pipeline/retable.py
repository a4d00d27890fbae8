"""Make the tables of a published study anew from its scores, after a table got a column.

python -m pipeline.retable results/study
python -m pipeline.retable results/organic

No score is measured anew, and none changes; `made.json` says when and at which commit the tables
were made.  Pictures, which need more than the scores, stay as they are, and so does the goal about
what the reference rig sees; `python -m pipeline.publish readme` then brings the documents up to
date.
"""

from pathlib import Path

from industnerf.artifacts.files import write_json, write_text
from industnerf.cli import run_command
from industnerf.config import read_yaml
from industnerf.parts.catalogue import catalogue
from industnerf.parts.embedded import as_part
from industnerf.report.build import table_texts
from industnerf.report.provenance import origin, read_made
from industnerf.report.publish import about
from industnerf.report.reread import reread_study


def main(published: str) -> None:
    folder = Path(published)
    for name, text in tables(folder).items():
        write_text(folder / name, text)
    made = read_made(folder) | {"retabled": _now()}
    write_json(folder / "made.json", made)
    write_text(folder / "README.md", about(folder, made))


def _now() -> dict[str, str]:
    found = origin()
    return {name: found[name] for name in ("date", "commit")}


def tables(published: Path) -> dict[str, str]:
    """What the tables in the folder `published` should say, by the name of the file."""
    place = Path(read_yaml(published / "params.yaml")["parts"]["path"])
    return table_texts(reread_study(published, map(as_part, catalogue(place))))


if __name__ == "__main__":
    run_command(main)
