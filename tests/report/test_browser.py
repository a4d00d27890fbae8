"""The page in a browser: it draws, sorts, fetches nothing, and nobody complains of it."""

import pytest

from tests.report import gallery
from tests.report.browser import visit

# What tests ask of the page: the colours of either half of the viewer, and to choose in a list.
HELPERS = """
  const canvas = document.querySelector("#stage canvas");
  const picture = () => {
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
  const set = (where, value) => {
    const control = document.querySelector(where);
    if (control.type === "radio") control.checked = true;
    else control.value = value;
    control.dispatchEvent(new Event("change", { bubbles: true }));
  };
  const says = (side) => document.querySelector(`.pane.${side} .says`).textContent;
  const column = (table, i) => [...table.tBodies[0].rows].map((row) => row.cells[i].textContent);
"""
LEFT, RIGHT = ".pane.left select", ".pane.right select"


@pytest.fixture
def ask(report_page, tmp_path):
    """What a probe finds, of a page that nobody complained about."""

    def asked(probe: str, fragment: str = "") -> dict:
        seen = visit(report_page, HELPERS + probe, tmp_path, fragment)
        assert "thrown" not in seen.found, seen.found["thrown"]
        assert seen.complaints == []
        return seen.found

    return asked


def test_the_viewer_draws_both_sides_and_every_choice_shows(ask):
    found = ask(f"""
      const start = picture();
      const of = {{}};
      for (const name of ["error", "confidence", "view", "photo"]) {{
        set(`[name=colouring][value=${{name}}]`);
        of[name] = picture();
      }}
      set("[name=colouring][value=error]");
      set("[name=limit]", "0.05");
      const wide = picture();
      set("{RIGHT}", "oracle");
      const other = picture();
      return {{ start, of, wide, other, says: says("right") }};
    """)
    for half in found["start"]:
        assert 0.1 < half["drawn"] < 0.9  # a ball, and paper round it
    right = [found["of"][name][1]["sum"] for name in found["of"]]
    assert len({str(colours) for colours in right}) == 4
    assert found["of"]["error"] == found["start"]
    assert found["wide"] != found["start"]
    assert found["other"] != found["wide"]
    assert "EMD 0.0100 = 0.346 mm (1.00 x floor)" in found["says"]


def test_both_sides_have_one_camera(ask):
    """The same cloud on both sides is the same picture, also after a turn."""
    found = ask(f"""
      set("{LEFT}", "oracle");
      set("{RIGHT}", "oracle");
      set("[name=colouring][value=photo]");
      const before = picture();
      const press = (key) => canvas.dispatchEvent(new KeyboardEvent("keydown", {{ key }}));
      press("ArrowLeft");
      press("+");
      const after = picture();
      press("0");
      return {{ before, after, back: picture() }};
    """)
    for two in (found["before"], found["after"]):
        assert two[0]["sum"] == pytest.approx(two[1]["sum"], rel=1e-3)  # rounded to px apart
    assert found["after"][0]["drawn"] > 1.1 * found["before"][0]["drawn"]
    assert found["back"] == found["before"]


def test_a_failed_cloud_and_one_that_says_nothing_are_named_and_not_invented(ask):
    found = ask(f"""
      set("{RIGHT}", "box");
      const failed = [says("right"), picture()[1].drawn];
      set("{RIGHT}", "oracle");
      const silent = {{}};
      for (const name of ["confidence", "view", "photo"]) {{
        set(`[name=colouring][value=${{name}}]`);
        silent[name] = says("right");
      }}
      return {{ failed, silent }};
    """)
    assert found["failed"] == [f"failed: {gallery.BROKEN}", 0]
    assert "states no confidence" in found["silent"]["confidence"]
    assert "which view" in found["silent"]["view"]
    assert "no colours" in found["silent"]["photo"]


def test_hidden_truth_has_a_colour_of_its_own(ask):
    found = ask("""
      set("[name=colouring][value=view]");
      const near = picture()[0];
      set("[name=part]", "far-ball");
      return { near, far: picture()[0], more: document.querySelector("#more").hash };
    """)
    red, _, blue = found["near"]["sum"]
    assert red > 1.1 * blue  # orange towards the eye
    red, _, blue = found["far"]["sum"]
    assert blue > red
    assert found["more"] == "#part=far-ball"


def test_tables_sort_by_number_and_by_name_both_ways(ask):
    found = ask("""
      const table = document.querySelector("table");
      const heads = [...table.tHead.rows[0].cells];
      const at = (name) => heads.find((head) => head.textContent === name);
      const click = (name) => {
        at(name).querySelector("button").click();
        return [at(name).getAttribute("aria-sort"), column(table, 0)];
      };
      return { up: click("EMD (even)"), down: click("EMD (even)"), name: click("method") };
    """)
    assert found == {
        "up": ["ascending", ["oracle", "hull", "box"]],
        "down": ["descending", ["box", "hull", "oracle"]],
        "name": ["ascending", ["box", "hull", "oracle"]],
    }


def test_a_part_has_its_own_address(ask):
    found = ask(
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
    assert found["shown"] == ["part=far-ball"]
    assert found["viewer"] == "far-ball"
    for text in ("20.0 x 20.0 x 20.0 mm", "within 0.5 mm", "0.7500", "Hausdorff-95, mm"):
        assert text in found["text"]


def test_nothing_is_fetched_and_the_browser_would_refuse_it(report_page, tmp_path):
    probe = 'return performance.getEntriesByType("resource").map((one) => one.name);'
    fetched = visit(report_page, probe, tmp_path)
    assert [name for name in fetched.found if not name.startswith("data:")] == []
    bad = report_page.replace("<h2>", "<img src='http://localhost/x.png'><h2>", 1)
    (tmp_path / "bad").mkdir()
    (refused,) = visit(bad, probe, tmp_path / "bad").complaints
    assert "localhost/x.png" in refused
    assert "Content Security Policy" in refused
