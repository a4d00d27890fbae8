"""`parts list` says every id whole, however narrow the terminal is."""

from io import StringIO

import pytest
from rich.console import Console

from industnerf.parts.catalogue.build import print_catalogue
from industnerf.parts.catalogue.catalogues import catalogue_folder
from industnerf.parts.catalogue.entries import read_catalogue


def printed(name: str, **console: object) -> list[str]:
    file = StringIO()
    print_catalogue(Console(file=file, color_system=None, **console), name)
    return file.getvalue().splitlines()


@pytest.mark.parametrize("name", ["embedded", "organic"])
@pytest.mark.parametrize("width", [40, 80, 120, 250])
def test_ids_are_whole_and_lines_fit_a_terminal(name, width):
    lines = printed(name, width=width, force_terminal=True)
    ids = [entry.id for entry in read_catalogue(catalogue_folder(name))]
    words = [line.split()[0] for line in lines if line.strip()]
    assert [word for word in words if word in ids] == ids
    assert "…" not in "".join(lines)
    narrowest = max(map(len, ids)) + len("123.4 x 123.4 x 123.4") + 5
    assert max(map(len, lines)) <= max(width, narrowest)


def test_a_pipe_gets_every_column():
    lines = printed("embedded", width=80, force_terminal=False)
    heading = next(line for line in lines if "designation" in line)
    assert heading.split("  ")[0].strip() == "part"
    assert {"drawn with", "bodies", "faces"} <= {text.strip() for text in heading.split("  ")}
    assert any("ISO 15 7304" in line and "bearing" in line for line in lines)
