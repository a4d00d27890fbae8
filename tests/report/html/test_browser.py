"""The page in a browser: it draws, sorts, fetches nothing, and nobody complains of it."""

import pytest

from tests.report import ball_study
from tests.report.html.browser import visit

# What tests ask of the page: the colors of either half of the viewer, and to choose in a list.
HELPERS = """
  const canvas = document.querySelector("#stage canvas");
  const canvasColors = () => {
    const flat = document.createElement("canvas");
    [flat.width, flat.height] = [canvas.width, canvas.height];
    const context = flat.getContext("2d", { willReadFrequently: true });
    context.drawImage(canvas, 0, 0);
    const half = Math.floor(flat.width / 2);
    return [0, half].map((x) => {
      const { data } = context.getImageData(x, 0, half, flat.height);
      let [drawn, red, green, blue] = [0, 0, 0, 0];
      for (let i = 0; i < data.length; i += 4) {
        if (data[i] === 255 && data[i + 1] === 255 && data[i + 2] === 255) continue;
        drawn++;
        [red, green, blue] = [red + data[i], green + data[i + 1], blue + data[i + 2]];
      }
      return { drawn: drawn / (half * flat.height), sum: [red, green, blue] };
    });
  };
  const viewer = document.getElementById("viewer");
  const drawn = async () => {
    const busy = () => viewer.getAttribute("aria-busy") !== "false";
    while (busy()) await new Promise((go) => setTimeout(go, 5));
  };
  const set = async (where, value) => {
    const control = document.querySelector(where);
    if (control.type === "radio") control.checked = true;
    else control.value = value;
    control.dispatchEvent(new Event("change", { bubbles: true }));
    await drawn();
  };
  const caption = (side) => document.querySelector(`.pane.${side} .caption`).textContent;
  const column = (table, i) => [...table.tBodies[0].rows].map((row) => row.cells[i].textContent);
"""
LEFT, RIGHT = ".pane.left select", ".pane.right select"


@pytest.fixture
def probe_page(report_page, tmp_path):
    """What a probe finds, of a page that nobody complained about."""

    def run_probe(probe: str, fragment: str = "") -> dict:
        visited = visit(report_page, HELPERS + probe, tmp_path, fragment)
        assert "thrown" not in visited.result, visited.result["thrown"]
        assert visited.console_messages == []
        return visited.result

    return run_probe


def test_the_viewer_draws_both_sides_and_every_choice_shows(probe_page):
    result = probe_page(f"""
      await drawn();
      const start = canvasColors();
      const of = {{}};
      for (const name of ["error", "confidence", "view", "photo"]) {{
        await set(`[name=coloring][value=${{name}}]`);
        of[name] = canvasColors();
      }}
      await set("[name=coloring][value=error]");
      await set("[name=limit]", "0.05");
      const wide = canvasColors();
      await set("{RIGHT}", "oracle");
      const other = canvasColors();
      return {{ start, of, wide, other, caption: caption("right") }};
    """)
    for half in result["start"]:
        assert 0.1 < half["drawn"] < 0.9  # a ball, and paper round it
    right = [result["of"][name][1]["sum"] for name in result["of"]]
    assert len({str(colors) for colors in right}) == 4
    assert result["of"]["error"] == result["start"]
    assert result["wide"] != result["start"]
    assert result["other"] != result["wide"]
    assert "EMD 0.0100 = 0.346 mm (1.00 x floor)" in result["caption"]


def test_a_browser_that_cannot_unpack_says_so(report_page, tmp_path):
    old = report_page.replace("<h2", "<script>delete window.DecompressionStream</script><h2", 1)
    probe = 'return document.querySelector("#legend").textContent;'
    visited = visit(old, probe, tmp_path)
    assert "cannot unpack" in visited.result
    assert visited.console_messages == []


def test_both_sides_have_one_camera(probe_page):
    """The same cloud on both sides looks the same, also after a turn."""
    result = probe_page(f"""
      await set("{LEFT}", "oracle");
      await set("{RIGHT}", "oracle");
      await set("[name=coloring][value=photo]");
      const before = canvasColors();
      const press = (key) => canvas.dispatchEvent(new KeyboardEvent("keydown", {{ key }}));
      press("ArrowLeft");
      press("+");
      const after = canvasColors();
      press("0");
      return {{ before, after, back: canvasColors() }};
    """)
    for two in (result["before"], result["after"]):
        assert two[0]["sum"] == pytest.approx(two[1]["sum"], rel=1e-3)  # rounded to px apart
    assert result["after"][0]["drawn"] > 1.1 * result["before"][0]["drawn"]
    assert result["back"] == result["before"]


def test_a_failed_cloud_and_one_that_says_nothing_are_named_and_not_invented(probe_page):
    result = probe_page(f"""
      await set("{RIGHT}", "box");
      const failed = [caption("right"), canvasColors()[1].drawn];
      await set("{RIGHT}", "oracle");
      const silent = {{}};
      for (const name of ["confidence", "view", "photo"]) {{
        await set(`[name=coloring][value=${{name}}]`);
        silent[name] = caption("right");
      }}
      return {{ failed, silent }};
    """)
    assert result["failed"] == [f"failed: {ball_study.FAILURE}", 0]
    assert "states no confidence" in result["silent"]["confidence"]
    assert "which view" in result["silent"]["view"]
    assert "no colors" in result["silent"]["photo"]


def test_hidden_truth_has_a_color_of_its_own(probe_page):
    result = probe_page("""
      await set("[name=coloring][value=view]");
      const near = canvasColors()[0];
      await set("[name=part]", "far-ball");
      return { near, far: canvasColors()[0], more: document.querySelector("#more").hash };
    """)
    red, _, blue = result["near"]["sum"]
    assert red > 1.1 * blue  # orange towards the eye
    red, _, blue = result["far"]["sum"]
    assert blue > red
    assert result["more"] == "#part=far-ball"


def test_tables_sort_by_number_and_by_name_both_ways(probe_page):
    result = probe_page("""
      const table = document.querySelector("table");
      const heads = [...table.tHead.rows[0].cells];
      const at = (name) => heads.find((head) => head.textContent === name);
      const click = (name) => {
        at(name).querySelector("button").click();
        return [at(name).getAttribute("aria-sort"), column(table, 0)];
      };
      return { up: click("EMD (even)"), down: click("EMD (even)"), name: click("method") };
    """)
    assert result == {
        "up": ["ascending", ["oracle", "hull", "box"]],
        "down": ["descending", ["box", "hull", "oracle"]],
        "name": ["ascending", ["box", "hull", "oracle"]],
    }


def test_a_part_has_its_own_address(probe_page):
    result = probe_page(
        """
      const shown = [...document.querySelectorAll(".part")].filter((one) => one.offsetHeight);
      document.querySelector(".part:target [data-scene]").click();
      return {
        shown: shown.map((one) => one.id),
        text: shown[0].textContent,
        viewer: document.querySelector("[name=part]").value,
      };
    """,
        "#part=far-ball",
    )
    assert result["shown"] == ["part=far-ball"]
    assert result["viewer"] == "far-ball"
    for text in ("20.0 x 20.0 x 20.0 mm", "within 0.5 mm", "0.7500", "Hausdorff-95, mm"):
        assert text in result["text"]


def test_nothing_is_fetched_and_the_browser_would_refuse_it(report_page, tmp_path):
    probe = 'return performance.getEntriesByType("resource").map((one) => one.name);'
    fetched = visit(report_page, probe, tmp_path)
    assert [name for name in fetched.result if not name.startswith("data:")] == []
    bad = report_page.replace("<h2>", "<img src='http://localhost/x.png'><h2>", 1)
    (tmp_path / "bad").mkdir()
    (refused,) = visit(bad, probe, tmp_path / "bad").console_messages
    assert "localhost/x.png" in refused
    assert "Content Security Policy" in refused
