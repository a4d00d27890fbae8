"""What `hydra/sweeper=optuna` may tune on, and what it makes small.

python -m pipeline.sweep -m hydra/sweeper=optuna experiment=dev 'methods=[carve]' \\
    'method.carve.color_threshold=interval(0.01, 0.2)'
"""

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from industnerf.config import DEFAULT_PARAMS, load_params
from industnerf.errors import BadParams
from industnerf.schema import Params

TUNED_SPLIT = "dev"


def objective(folder: Path) -> float | None:
    """EMD over the floor, the means over the dev parts, of the one method of the point in `folder`.

    It is the column `x floor` of the tables.  None if there are several methods, or test parts.
    """
    from industnerf.report.tables.formats import read_csv

    rows = read_csv(folder / "reports/table1.csv")
    if len(rows) != 1 or rows[0]["split"] != TUNED_SPLIT:
        return None
    return float(rows[0]["ratio_to_floor"])


def check_tuning(points: Sequence[Params]) -> None:
    """Raises BadParams unless Optuna is installed, and each point is one method on dev parts."""
    if find_spec("optuna") is None:
        raise BadParams("hydra/sweeper=optuna needs Optuna: pip install -e '.[tune]'")
    for params in points:
        if len(params.methods) != 1:
            raise BadParams(
                f"a tuning makes the EMD of one method small, methods are {params.methods}: "
                f"'methods=[{params.methods[0]}]'"
            )
        if params.split != load_params(DEFAULT_PARAMS).split:
            raise BadParams("a tuning keeps the split of params.yaml: leave out split.*")
        _check_parts(params)


def _check_parts(params: Params) -> None:
    """Raises BadParams if a part is none that may be tuned on."""
    from industnerf.parts.catalogue.entries import read_catalogue
    from industnerf.parts.split import is_dev

    advice = "experiment=dev and experiment=four take dev parts alone"
    if params.parts.source != "embedded":
        raise BadParams(f"parts of your own are all of the split test, and not tuned on; {advice}")
    entries = read_catalogue(Path(params.parts.path))
    test = [
        entry.id
        for entry in entries
        if (not params.parts.select or entry.id in params.parts.select)
        and not is_dev(entry.id, entry.origin, params.split)
    ]
    if test:
        shown = ", ".join(test[:5]) + (f" and {len(test) - 5} more" if len(test) > 5 else "")
        raise BadParams(f"parts.select: {shown} are of the split test, and not tuned on; {advice}")
