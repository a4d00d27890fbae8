"""A page in headless Chromium that can reach nothing, and what a script finds out about it.

Debian's `chromium` serves, or Chrome; software draws the WebGL, so that no GPU is needed.
"""

import html
import json
import re
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
LIMIT_S = 180  # a browser that hangs must not hang the tests
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-dev-shm-usage",
    "--disable-background-networking",
    "--host-resolver-rules=MAP * ~NOTFOUND",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--enable-logging=stderr",
    "--virtual-time-budget=60000",  # ms: what is decoded meanwhile is waited for
    "--window-size=1400,900",
)
# The probe's value is left in the page; the policy of the page is the first thing it would break.
PROBE = """<script>
addEventListener("load", async () => {
  const found = document.createElement("pre");
  found.id = "found";
  try {
    found.textContent = JSON.stringify(await (async () => { %s })());
  } catch (error) {
    found.textContent = JSON.stringify({ thrown: String(error) });
  }
  document.body.append(found);
});
</script>"""


@dataclass(frozen=True)
class PageVisit:
    """What came of a page."""

    result: dict  # what the probe returned
    console_messages: list[str]  # all that the console said: errors, warnings, refusals


def visit(page: str, probe: str, folder: Path, fragment: str = "") -> PageVisit:
    """Open `page` at `fragment`, run the body `probe` of a function once it is loaded.

    Skips the test where no browser is installed.
    """
    browser = next(filter(None, map(shutil.which, NAMES)), None)
    if browser is None:
        pytest.skip(f"no browser to open the page in: none of {', '.join(NAMES)} is installed")
    file = folder / "page.html"
    file.write_text(page.replace("</html>", PROBE % probe + "</html>"))
    command = [browser, *FLAGS, f"--user-data-dir={folder / 'profile'}", "--dump-dom"]
    process = subprocess.run(
        [*command, file.as_uri() + fragment], capture_output=True, text=True, timeout=LIMIT_S
    )
    match = re.search(r'<pre id="found">(.*?)</pre>', process.stdout, re.S)
    assert match, f"the page did not load: {process.stderr[-2000:]}"
    console_messages = [line for line in process.stderr.splitlines() if "CONSOLE" in line]
    return PageVisit(json.loads(html.unescape(match[1])), console_messages)
