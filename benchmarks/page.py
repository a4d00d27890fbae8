"""How large is the page of a report, and how long does a browser take to open it?

PYTHONPATH=. python benchmarks/page.py runs/dev/reports/report.html 1000 4000

A number stands for a page of so many parts, with three methods, 14 scores and no images each.
In headless Chromium, where software draws: seconds until all of the file is read
(`domInteractive`), and until the scripts have run and every image is decoded (`load`).
"""

import sys
import tempfile
from pathlib import Path
from statistics import median

from tests.report import ball_study
from tests.report.html.browser import visit
from tests.report.html.test_page import bare_page
from tests.report.html.test_size import with_parts

REPEATS = 3
PROBE = """
  const [opened] = performance.getEntriesByType("navigation");
  return { read: opened.domInteractive / 1000, loaded: performance.now() / 1000 };
"""


def main(*pages: str) -> None:
    print(f"{'MB':>6} {'s read':>7} {'s loaded':>9}  median of {REPEATS}")
    for name in pages:
        page = page_of_parts(int(name)) if name.isdigit() else Path(name).read_text()
        timings = [open_page(page) for _ in range(REPEATS)]
        read, loaded = (median(timing[key] for timing in timings) for key in ("read", "loaded"))
        print(f"{len(page.encode()) / 1e6:6.2f} {read:7.2f} {loaded:9.2f}  {name}", flush=True)


def page_of_parts(count: int) -> str:
    """The page of a study of equal balls."""
    with tempfile.TemporaryDirectory() as folder:
        for name in ball_study.PARTS:
            ball_study.write_part(Path(folder), name)
        return bare_page(with_parts(ball_study.study(Path(folder)), count))


def open_page(page: str) -> dict[str, float]:
    """Seconds, in a browser that has seen no page before."""
    with tempfile.TemporaryDirectory() as folder:
        return visit(page, PROBE, Path(folder)).result


if __name__ == "__main__":
    main(*sys.argv[1:])
