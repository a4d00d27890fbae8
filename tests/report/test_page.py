"""The page as a file: complete, self-contained, equal from run to run, and nothing unescaped."""

import re
from dataclasses import replace
from html.parser import HTMLParser

import pytest

from industnerf.report.exhibits import Exhibits, exhibits
from industnerf.report.formats import brief
from industnerf.report.markup import Column, Line, part_link, table
from industnerf.report.page import page
from industnerf.report.results import Results
from industnerf.report.scenes import scene
from industnerf.report.sheet import contact_sheet
from industnerf.report.snapshots import Snapshots
from tests.report import gallery
from tests.report.conftest import SETTINGS
from tests.samples import unit_part
from tests.studies import study_of


def bare(study) -> str:
    """A page without exhibits."""
    return page(Results.of(study, SETTINGS), Exhibits(b"", [], Snapshots([], []), b""))


class Links(HTMLParser):
    """What a page points at, and what it can be pointed at."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.targets, self.places = set(), set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.targets |= {given[name] for name in ("href", "src") if name in given}
        self.places |= {given["id"]} if "id" in given else set()


def test_every_link_leads_somewhere_within_the_page(report_page):
    links = Links(report_page)
    inside = {target[1:] for target in links.targets if target.startswith("#")} - {""}
    assert inside <= links.places
    assert {f"part={name}" for name in gallery.PARTS} <= inside
    others = {target for target in links.targets if target and not target.startswith("#")}
    assert all(target.startswith("data:") for target in others)


def test_equal_results_give_equal_bytes(study, report_page):
    again = scene(study, study.parts["near-ball"])
    assert again == scene(study, study.parts["near-ball"])
    assert bare(study) == bare(study)


def test_what_others_wrote_stays_text(study):
    broken = "<script>alert(1)</script>"
    parts = {name: replace(part, designation=broken) for name, part in study.parts.items()}
    shown = bare(replace(study, parts=parts, failures={"hull": {"near-ball": broken}}))
    assert shown.count(broken) == 0
    assert shown.count("&lt;script&gt;alert") >= 3


def test_what_a_method_remarked_stands_with_the_part_and_in_a_list(study):
    said = {"hull": {"near-ball": ["the <images> contradict each other"]}}
    shown = bare(replace(study, remarks=said))
    assert shown.count("the &lt;images&gt; contradict each other") == 2
    assert "What methods remarked" not in bare(study)


def test_curves_stand_where_there_are_some(study):
    shown = Exhibits(b"", [], Snapshots([], []), b"", curves=b"some PNG")
    assert page(Results.of(study, SETTINGS), shown).count("alt='sparsification curves'") == 1
    assert "sparsification curves'" not in bare(study)


def test_a_part_that_could_not_be_scored_is_said(study):
    scored = [row for row in study.scores if row.part_id != "near-ball"]
    shown = bare(replace(study, scores=scored, failures={"truth": {"near-ball": "too thin"}}))
    assert "1 have no score: see Failures." in shown
    assert "too thin" in shown
    assert bare(study).count("have no score") == 0


def test_a_name_cannot_end_the_element_that_holds_the_clouds(study):
    failures = {"box": {"near-ball": "</script><b>"}}
    told = replace(study, failures=failures)
    one = scene(told, told.parts["near-ball"])
    shown = page(Results.of(told, SETTINGS), Exhibits(b"", [one], Snapshots([], []), b""))
    assert shown.count("</script><b>") == 0


def test_emd_stands_in_mm_beside_diagonals(report_page):
    """0.02 diagonals of 34.64 mm."""
    row = re.search(r"<td class=text>hull<td class=text>mask(.*?)<tr", report_page)[1]
    assert row.split("<td>")[1:] == [
        "12",
        "0.0200",
        "0.0200 to 0.0200",
        "0.693",
        "0.0100",
        "2.00",
        "0.0200",
        "0.0200",
        "2",
        "0",
    ]


def test_a_part_shows_every_metric_with_its_unit_and_who_failed(report_page):
    section = report_page.split("id='part=near-ball'")[1].split("</section>")[0]
    for text in ("EMD (even)", "mm", "cloud within 0.5 mm, share", "Hausdorff-95, mm"):
        assert f"<button>{text}</button>" in section
    assert "error_left" not in section  # points of a curve, which stands further up
    assert "<tr class=failed><td class=text>box<td>0.2000 (failed)<td>6.93" in section
    assert "no silhouette &lt;seen&gt;" in section


def test_sheet_and_viewer_say_which_of_several_answers_they_show(report_page):
    for name in ("Contact sheet", "Truth and reconstruction"):
        section = report_page.split(f">{name}</h2>")[1].split("<h2")[0]
        assert re.search("[Oo]f several answers of a net (it is )?the first", section)


def test_the_headline_and_the_table_of_parts_have_mm_too(report_page):
    """The mean of the mm of parts: the second, twice as large, weighs twice."""
    parts = [unit_part("a", "f"), unit_part("b", "g", extents_mm=(2.0, 2.0, 2.0))]
    shown = bare(study_of(parts, {"industnerf": [0.02, 0.06], "hull": [0.02, float("inf")]}))
    assert "<b>industnerf</b> is at 0.0400 (4.00 floors, 0.121 mm)" in shown
    assert "<td>0.0600 <small>0.208 mm</small>" in shown
    table_of_parts = report_page.split("id='part-by-part'")[1].split("</table>")[0]
    assert "<td>0.2000 <small>6.93 mm</small><em> (failed)</em>" in table_of_parts


def test_a_part_leads_to_its_neighbours_and_shows_its_picture(report_page):
    near, far = (report_page.split(f"id='part={name}'")[1] for name in gallery.PARTS)
    assert "<figcaption>photograph</figcaption>" in near.split("</section>")[0]
    assert "<a href='#part=far-ball'>" in near.split("</section>")[0]
    assert "<a href='#part=near-ball'>" in far.split("</section>")[0]


def test_sections_are_linked_from_the_top_and_the_day_is_named(report_page):
    contents = re.search("<nav class=contents>(.*?)</nav>", report_page)[1]
    assert "<a href='#part-by-part'>Part by part</a>" in contents
    assert "Made on a day." in report_page


def test_failures_are_listed_also_of_parts_that_never_became_one(report_page):
    assert "<b>parts</b>, torn-part: torn.step: no solid" in report_page
    assert report_page.count(">Failures</h2>") == 1


def test_what_there_is_nothing_of_is_left_out(study):
    shown = bare(
        replace(study, failures={}, scores=[s for s in study.scores if s.score.metric == "emd"])
    )
    assert shown.count("Failures") == 0
    assert shown.count("Is the confidence right?") == 0
    assert shown.count("Held-out views") == 0
    assert "nothing to show" in shown


def test_a_page_without_a_part_to_show_has_no_sheet(study):
    assert contact_sheet(study, []) is None
    shown = exhibits(study, [], None, b"", None)
    text = page(Results.of(study, SETTINGS), shown)
    assert text.count("Contact sheet") == 0
    assert "Table 1" in text


def test_a_table_leaves_out_the_columns_that_no_line_fills():
    columns = [Column("a", True), Column("b"), Column("c")]
    text = table(columns, [Line(["x", "", "1"]), Line(["y", "", ""], "failed")])
    assert re.findall(r"<button>(\w)", text) == ["a", "c"]
    assert "<tr class=failed><td class=text>y<td></tbody>" in text


def test_a_link_survives_any_id():
    assert part_link("a b#'c", "<x>") == "<a href='#part=a%20b%23%27c'>&lt;x&gt;</a>"


@pytest.mark.parametrize(
    ("value", "text"), [(0.0123456, "0.0123"), (2.0, "2.00"), (34.64, "34.6"), (1234.5, "1234")]
)
def test_lengths_have_three_digits(value, text):
    assert brief(value) == text
