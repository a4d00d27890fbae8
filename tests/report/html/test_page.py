"""The page as a file: complete, self-contained, equal from run to run, and nothing unescaped."""

import re
from dataclasses import replace
from html.parser import HTMLParser

import pytest

from industnerf.methods import load_method
from industnerf.report.figures.contact_sheet import draw_contact_sheet, shown_methods
from industnerf.report.figures.held_out_renderings import HeldOutRenderings
from industnerf.report.html.page import PageMedia, load_page_media, render_page
from industnerf.report.html.viewer import pack_scene
from industnerf.report.results import Results
from industnerf.report.tables.formats import format_significant
from tests.report import ball_study
from tests.report.conftest import SETTINGS
from tests.samples import unit_part
from tests.studies import make_study


def bare_page(study) -> str:
    """A page without media."""
    return render_page(
        Results.from_study(study, SETTINGS), PageMedia(b"", [], HeldOutRenderings([], []), b"")
    )


class Links(HTMLParser):
    """What a page points at, and what it can be pointed at."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.targets, self.anchors = set(), set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        by_name = dict(attributes)
        self.targets |= {by_name[name] for name in ("href", "src") if name in by_name}
        self.anchors |= {by_name["id"]} if "id" in by_name else set()


def test_every_link_leads_somewhere_within_the_page(report_page):
    links = Links(report_page)
    inside = {target[1:] for target in links.targets if target.startswith("#")} - {""}
    assert inside <= links.anchors
    assert {f"part={name}" for name in ball_study.PARTS} <= inside
    others = {target for target in links.targets if target and not target.startswith("#")}
    assert all(target.startswith("data:") for target in others)


def test_equal_results_give_equal_bytes(study, report_page):
    again = pack_scene(study, study.parts["near-ball"])
    assert again == pack_scene(study, study.parts["near-ball"])
    assert bare_page(study) == bare_page(study)


def test_what_others_wrote_stays_text(study):
    broken = "<script>alert(1)</script>"
    parts = {name: replace(part, designation=broken) for name, part in study.parts.items()}
    page_html = bare_page(replace(study, parts=parts, failures={"hull": {"near-ball": broken}}))
    assert page_html.count(broken) == 0
    assert page_html.count("&lt;script&gt;alert") >= 3


def test_input_warnings_stand_with_the_part_and_in_a_list(study):
    input_warnings = {"hull": {"near-ball": ["the <images> contradict each other"]}, "views": {}}
    page_html = bare_page(replace(study, input_warnings=input_warnings))
    assert page_html.count("the &lt;images&gt; contradict each other") == 2
    assert "Warnings about parts and images" not in bare_page(study)


def test_curves_stand_where_there_are_some(study):
    page_html = PageMedia(b"", [], HeldOutRenderings([], []), b"", sparsification_plot=b"some PNG")
    assert (
        render_page(Results.from_study(study, SETTINGS), page_html).count(
            "alt='sparsification curves'"
        )
        == 1
    )
    assert "sparsification curves'" not in bare_page(study)


def test_a_part_that_could_not_be_scored_is_said(study):
    scored = [row for row in study.scores if row.part_id != "near-ball"]
    page_html = bare_page(
        replace(study, scores=scored, failures={"truth": {"near-ball": "too thin"}})
    )
    assert "1 have no score: see Failures." in page_html
    assert "too thin" in page_html
    assert bare_page(study).count("have no score") == 0


def test_a_name_cannot_end_the_element_that_holds_the_clouds(study):
    failures = {"box": {"near-ball": "</script><b>"}}
    changed = replace(study, failures=failures)
    one = pack_scene(changed, changed.parts["near-ball"])
    page_html = render_page(
        Results.from_study(changed, SETTINGS), PageMedia(b"", [one], HeldOutRenderings([], []), b"")
    )
    assert page_html.count("</script><b>") == 0


def test_emd_stands_in_mm_beside_diagonals(report_page):
    """0.02 diagonals of 34.64 mm."""
    row = re.search(r"<td class=text>hull<td class=text>mask(.*?)<tr", report_page)[1]
    assert row.split("<td>")[1:] == [
        "12",
        "0.0200",
        "0.693",  # no interval: both parts are of one family
        "0.0100",
        "0.00000",
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


def test_sheet_and_viewer_say_which_of_several_predictions_they_show(report_page):
    for name in ("Contact sheet", "Truth and reconstruction"):
        section = report_page.split(f">{name}</h2>")[1].split("<h2")[0]
        assert re.search(
            "[Oo]f several predictions of a network (it is )?the first", " ".join(section.split())
        )


def test_the_headline_and_the_table_of_parts_have_mm_too(report_page):
    """The mean of the mm of parts: the second, twice as large, weighs twice."""
    parts = [unit_part("a", "f"), unit_part("b", "g", extents_mm=(2.0, 2.0, 2.0))]
    page_html = bare_page(
        make_study(parts, {"industnerf": [0.02, 0.06], "hull": [0.02, float("inf")]})
    )
    assert "<b>industnerf</b> is at 0.0400 (4.00 x floor, 0.121 mm)" in page_html
    assert "<td>0.0600 <small>0.208 mm</small>" in page_html
    table_of_parts = report_page.split("id='parts'")[1].split("</table>")[0]
    assert "<td>0.2000 <small>6.93 mm</small><em> (failed)</em>" in table_of_parts


def test_a_part_leads_to_its_neighbors_and_shows_its_image(report_page):
    near, far = (report_page.split(f"id='part={name}'")[1] for name in ball_study.PARTS)
    assert "<figcaption>image</figcaption>" in near.split("</section>")[0]
    assert "<a href='#part=far-ball'>" in near.split("</section>")[0]
    assert "<a href='#part=near-ball'>" in far.split("</section>")[0]


def test_sections_are_linked_from_the_top_and_the_day_is_named(report_page):
    contents = re.search("<nav class=contents>(.*?)</nav>", report_page)[1]
    assert "<a href='#parts'>Parts</a>" in contents
    assert "Made on a day." in report_page


def test_failures_are_listed_also_of_parts_that_never_became_one(report_page):
    assert "<b>parts</b>, torn-part: torn.step: no solid" in report_page
    assert report_page.count(">Failures</h2>") == 1


def test_what_there_is_nothing_of_is_left_out(study):
    page_html = bare_page(
        replace(study, failures={}, scores=[s for s in study.scores if s.score.metric == "emd"])
    )
    assert page_html.count("Failures") == 0
    assert page_html.count("Calibration of confidence") == 0
    assert page_html.count("Held-out views") == 0
    assert "nothing to show" in page_html


@pytest.mark.parametrize(
    ("names", "shown"),
    [(["hull", "ball", "oracle"], ["hull", "oracle"]), (["ball", "box"], ["ball", "box"])],
)
def test_nulls_are_on_the_sheet_only_where_there_is_nothing_else(names, shown):
    assert shown_methods({name: load_method(name) for name in names}) == shown


def test_a_page_without_a_part_to_show_has_no_sheet(study):
    assert draw_contact_sheet(study, []) is None
    page_html = load_page_media(study, [], None, b"", None)
    text = render_page(Results.from_study(study, SETTINGS), page_html)
    assert text.count("Contact sheet") == 0
    assert "Table 1" in text


@pytest.mark.parametrize(
    ("value", "text"), [(0.0123456, "0.0123"), (2.0, "2.00"), (34.64, "34.6"), (1234.5, "1234")]
)
def test_lengths_have_three_digits(value, text):
    assert format_significant(value) == text
