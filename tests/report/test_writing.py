"""The page and the files beside it: complete, self-contained, escaped, and honest about gaps."""

from __future__ import annotations

import base64
import gzip
import json
import re
import shutil
import subprocess
import sys
from importlib import resources
from urllib.parse import unquote

import pytest
from markdown_it import MarkdownIt
from missing import take_away
from page_reader import PageReader
from run_builder import SMALL, RunBuilder

from surmount.analysis.explanation import link_table
from surmount.analysis.result import Analysis
from surmount.analysis.trust import describe_trust
from surmount.core.errors import InputError, IntegrityError, MissingExtraError, OutputError
from surmount.core.records import read_record, write_record
from surmount.experiment.stages import analyse
from surmount.report.contents import document_of
from surmount.report.document import vega
from surmount.report.document.markdown import markdown
from surmount.report.document.page import page
from surmount.report.document.parts import Document, Notice
from surmount.report.document.text import short
from surmount.report.figures.stills import StillFiles, draw
from surmount.report.pages import write_analysis_report, write_report
from surmount.report.results import read_run
from surmount.workflow.run_folder import open_run

FIGURES = {
    "figure-5-mixture-fit",
    "figure-6-distances-and-groups",
    "success-and-stability",
    "figure-7-learning-curves",
    "figure-7b-training-success",
    "figure-8-success",
    "figure-8b-survival",
    "figure-9-path-lengths",
    "figure-10-success-by-variant",
    "figure-11-profiles",
}
HOSTILE = "</script><img src=x onerror=alert(1)> $\\frac{1}{2}$ %{x} {{ 7*7 }} &amp;"


def test_every_figure_is_written_as_svg_png_and_csv(reported):
    written = {path.name for path in (reported.root / "figures").iterdir()}
    assert written == {f"{name}.{kind}" for name in FIGURES for kind in ("svg", "png", "csv")}
    for name in FIGURES:
        assert (reported.root / "figures" / f"{name}.png").read_bytes().startswith(b"\x89PNG")
        assert b"<svg" in (reported.root / "figures" / f"{name}.svg").read_bytes()


def test_page_tells_over_networks_how_far_and_how_soon(reported):
    record = read_record(reported.stages["statistics"].path("statistics.json"))
    read = PageReader(reported.text())
    mean = record["networks"]["mean_difference"]
    assert f"paired t-test {100 * mean['estimate']:+.1f} points" in read.text
    for group, curriculum, control in zip(
        record["groups"],
        *(record["steps_to_95"][arm] for arm in ("curriculum", "control")),
        strict=True,
    ):
        for arm, found in (("curriculum", curriculum), ("control", control)):
            median = found["median_steps"]
            cells = [
                f"{found['n_reached']} of 2" + (f", median {median:,.0f}" if median else ""),
                *("—" if steps is None else f"{steps:,.0f}" for steps in found["first_steps"]),
            ]
            assert f"{group} {arm} {' '.join(cells)}" in read.text.replace("\u2009", ",")


def test_page_tells_what_hangs_on_each_choice_and_when_the_first_level_ended(reported):
    analysis = Analysis.load(reported.stages["analysis"].path("analysis.json"))
    read = PageReader(reported.text())
    assert analysis.sensitivity
    for row in analysis.sensitivity:
        cells = f"{row.choice} {row.value} {row.n_groups} {row.agreement:.2f}"
        assert " ".join(cells.split()) in read.text
    ends = []
    for network in range(2):
        before = read_record(reported.stages[f"initiation/network-{network}"].path("training.json"))
        record = read_record(reported.stages[f"curriculum/network-{network}"].path("training.json"))
        (end,) = (test["steps"] for test in record["level_tests"]
                  if test["level"] == 0 and test["decision"] != "extend")  # fmt: skip
        ends.append(before["steps"] + end)
    expected = f"near 1,800,000 {min(ends):,} to {max(ends):,}"
    assert expected in read.text.replace("\u2009", ",")


def test_page_is_well_formed_and_accessible(reported):
    read = PageReader(reported.text())
    assert read.problems == []
    ids = [attributes["id"] for _, attributes in read.elements if "id" in attributes]
    assert len(ids) == len(set(ids))
    anchors = [a["href"][1:] for a in read.all("a") if a["href"].startswith("#")]
    assert set(anchors) <= set(ids)
    assert len(read.all("h1")) == 1
    assert all(image["alt"] for image in read.all("img"))
    drawings = [one for one in read.all("div") if one.get("role") == "img"]
    stills = [image for image in read.all("img") if image.get("class") == "still"]
    # Drawn or not, a figure is one image with its words; nothing inside Vega's drawing is read out.
    assert [one["aria-label"] for one in drawings] == [image["alt"] for image in stills]
    charts = [one for one in read.all("div") if one.get("class") == "chart"]
    assert len(charts) == len(drawings) == len(FIGURES)
    assert all(chart["aria-hidden"] == "true" for chart in charts)
    assert all("scope" in heading for heading in read.all("th"))
    assert read.all("html")[0]["lang"] == "en"


def test_pictures_are_in_the_page_as_they_are_in_their_files(reported):
    stills = [one for one in PageReader(reported.text()).all("img") if one["class"] == "still"]
    found = [unquote(still["src"].partition(",")[2]) for still in stills]
    written = [path.read_text(encoding="utf-8") for path in reported.root.glob("figures/*.svg")]
    assert sorted(found) == sorted(written)


def test_much_data_of_a_figure_lie_beside_the_page_alone(reported, monkeypatch):
    sizes = {path.stem: len(path.read_bytes()) for path in reported.root.glob("figures/*.csv")}
    limit = sorted(sizes.values())[len(sizes) // 2]
    monkeypatch.setattr("surmount.report.document.page.MOST_CSV", limit)
    charts = packed_charts(_page(reported.root, drawn=()))
    assert {name for name, chart in charts.items() if chart["csv"] is None} == {
        name for name, size in sizes.items() if size > limit
    }


def test_page_loads_nothing_from_anywhere(reported):
    read = PageReader(reported.text())
    for tag, attributes in read.elements:
        for name in ("src", "href", "srcset", "action", "poster", "data"):
            if name in attributes:
                assert attributes[name].startswith(("data:", "#")), (tag, name, attributes[name])
    assert not re.search(r"@import|url\(", "".join(read.styles))
    (policy,) = [m["content"] for m in read.all("meta") if "http-equiv" in m]
    assert "default-src 'none'" in policy  # the browser refuses whatever a script might try
    assert "connect-src" not in policy
    assert "http" not in policy


def test_page_shows_every_figure_and_both_tables_of_the_paper(reported):
    read = PageReader(reported.text())
    assert {figure["id"] for figure in read.all("figure")} == FIGURES
    assert "Table 1." in read.text
    assert "Table 2." in read.text
    for test in read_record(reported.stages["curriculum/network-1"].path("training.json"))[
        "level_tests"
    ]:
        assert " ".join(test["sentence"].split()) in read.text


def test_page_shows_the_whole_configuration_by_dotted_keys(reported):
    read = PageReader(reported.text())

    def leaves(tree, prefix=""):
        for key, value in tree.items():
            if isinstance(value, dict):
                yield from leaves(value, f"{prefix}{key}.")
            else:
                yield prefix + key

    keys = list(leaves(read_record(reported.root / "run.json")["config"]))
    assert len(keys) > 50
    words = set(read.text.split())
    assert [key for key in keys if key not in words] == []


def test_the_markdown_has_every_table_and_figure_of_the_page(reported):
    text = (reported.root / "report.md").read_text(encoding="utf-8")
    read = _parse(text)
    tables = sum(kind == "table_open" for kind, _ in read)
    assert tables == 1 + len(PageReader(reported.text()).all("table"))  # and the short facts
    pictures = {content for kind, content in read if kind == "image"}
    assert pictures == {f"figures/{name}.png" for name in FIGURES}
    linked = {content for kind, content in read if kind == "link_open"}
    assert linked == {f"figures/{name}.csv" for name in FIGURES}


def test_the_same_artefacts_give_the_same_bytes(reported):
    files = [
        reported.page,
        reported.page.with_suffix(".md"),
        *sorted((reported.root / "figures").iterdir()),
    ]
    before = {path: path.read_bytes() for path in files}
    write_report(reported.root)
    assert [path.name for path in files if path.read_bytes() != before[path]] == []


def test_the_page_is_small_and_shows_every_figure_before_it_draws_one(reported):
    assert reported.page.stat().st_size < 1_500_000
    read = PageReader(reported.text())
    pictures = [image for image in read.all("img") if image["class"] == "still"]
    assert len(pictures) == len(FIGURES)
    assert packed_charts(read).keys() == FIGURES


def test_the_packed_vega_is_the_one_that_pictures_are_drawn_by():
    assert vega.versions() in gzip.decompress(vega.packed()).decode()[:200]


def test_smoke_scale_is_said_and_paper_scale_is_not_called_smoke(reported, tmp_path):
    said = "Its numbers say nothing about the method's merit."
    assert said in PageReader(reported.text()).text
    RunBuilder(tmp_path, scale="paper")
    document = document_of(read_run(tmp_path))
    assert [notice.title for notice in document.notices] == ["Unfinished run"]


def test_hostile_names_are_shown_as_text_and_never_as_markup(tmp_path):
    builder = RunBuilder(tmp_path)
    builder.initiate()

    def renamed(context):
        analyse(context)
        for name in ("analysis.json", "curriculum.json"):
            path = context.output / name
            path.write_text(path.read_text().replace('"medium"', json.dumps(HOSTILE)))

    config = {"analysis": read_record(tmp_path / "run.json")["config"]["analysis"]}
    builder.run("analysis", renamed, config, trials="trials")
    builder.learn()
    builder.compare()
    run = read_record(tmp_path / "run.json")
    run["versions"][HOSTILE] = HOSTILE
    write_record(tmp_path / "run.json", run)

    read = _page(tmp_path, drawn=("figure-6-distances-and-groups", "figure-8-success"))
    page_text = "".join(text for _, text in read.scripts)
    assert read.problems == []
    assert {image["class"] for image in read.all("img")} == {"still"}
    assert not [a for _, a in read.elements if any(name.startswith("on") for name in a)]
    assert HOSTILE in read.text
    document = document_of(read_run(tmp_path))
    tokens = _parse(markdown(document, page="report.html", figures="figures"))
    raw = "".join(text for kind, text in tokens if kind.startswith("html"))
    assert set(re.findall(r"<[^>]*>", raw)) == {
        *("<details>", "<summary>", "</summary>", "</details>")
    }
    assert HOSTILE in "".join(text for kind, text in tokens if kind.startswith("text"))
    drawn = packed_charts(read)["figure-8-success"]
    assert short(HOSTILE) in {row["text"] for row in every_row(drawn["spec"]) if "text" in row}
    assert short(HOSTILE) not in page_text  # what is drawn is packed, and no part of the markup


@pytest.mark.parametrize(
    ("kept", "missing", "figures"),
    [
        (("initiation/network-0",), "trials/network-1", 2),
        (("initiation", "trials"), "analysis", 2),
        (("initiation", "trials", "analysis"), "statistics", 5),
        (
            ("initiation", "trials", "analysis", "curriculum", "test-curriculum"),
            "control/network-0",
            6,
        ),
    ],
)
def test_an_interrupted_run_shows_what_exists_and_says_what_is_missing(
    reported, tmp_path, kept, missing, figures
):
    root = _copy(reported.root, tmp_path)
    index = read_record(root / "index.json")
    index["stages"] = {
        name: folder
        for name, folder in index["stages"].items()
        if name.split("/")[0] in kept or name in kept
    }
    write_record(root / "index.json", index)
    results = read_run(root)
    assert missing in results.folder.missing
    document = document_of(results)
    (notice,) = [notice for notice in document.notices if notice.title == "Unfinished run"]
    assert f"{len(results.folder.missing)} stages" in notice.sentences[0]
    assert len(document.figures()) == figures
    assert "still to come" in document.summary[-1]


def test_a_killed_run_without_an_index_is_read_from_its_stages(reported, tmp_path):
    root = _copy(reported.root, tmp_path)
    (root / "index.json").unlink()
    (root / "timings.json").unlink()
    assert read_run(root).folder.stages.keys() == reported.stages.keys()


def test_a_run_that_has_only_begun_has_a_page(tmp_path):
    RunBuilder(tmp_path)
    read = PageReader(write_report(tmp_path).read_text(encoding="utf-8"))
    assert read.problems == []
    assert "0 networks of 2 finished the initiation" in read.text


def test_no_level_no_success_and_one_network_are_shown_with_their_reasons(tmp_path):
    nothing = (0.0, 0.0, 0.0)
    RunBuilder(
        tmp_path,
        success={"initiation": (1.0, 1.0, 1.0), "curriculum": nothing, "control": nothing},
        changes=SMALL | {"networks": 1},
    ).whole()
    read = _page(tmp_path, drawn=("figure-8b-survival", "figure-9-path-lengths"))
    assert read.problems == []
    assert "Every group already reaches 95 % success" in read.text.replace("\xa0", " ")
    assert "No trial of either arm succeeded" in read.text
    assert "fewer than two networks" in read.text
    assert "nan" not in read.text.lower().split()


@pytest.mark.parametrize(
    ("stage", "file"),
    [
        ("initiation/network-0", "history.parquet"),
        ("curriculum/network-1", "training.json"),
        ("trials/network-0", "trials.parquet"),
        ("test-control/network-1", "trials.parquet"),
        ("analysis", "analysis.json"),
        ("analysis", "curriculum.json"),
        ("statistics", "statistics.json"),
    ],
)
def test_a_tampered_artefact_is_refused(reported, tmp_path, stage, file):
    root = _copy(reported.root, tmp_path)
    path = root / reported.stages[stage].folder.relative_to(reported.root) / file
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)
    with pytest.raises(IntegrityError, match=re.escape(file)):
        write_report(root)
    assert not (root / "figures").exists()


def _hashes(root):
    return {name: found.content_hash for name, found in open_run(root).stages.items()}


@pytest.mark.parametrize("name", ["index.json", "timings.json", "restarts.json"])
@pytest.mark.parametrize(
    "content", ["", "{", '{"analysis": 1e999}', '{"analysis": %s}' % ("9" * 400)]
)
def test_a_damaged_journal_is_no_obstacle(reported, tmp_path, name, content):
    root = _copy(reported.root, tmp_path)
    (root / name).write_text(content, encoding="utf-8")
    assert _hashes(root) == _hashes(reported.root)


def test_an_index_that_leads_elsewhere_is_not_followed(reported, tmp_path):
    root = _copy(reported.root, tmp_path)
    index = read_record(root / "index.json")
    index["stages"]["analysis"] = index["stages"]["statistics"]
    write_record(root / "index.json", index)
    assert _hashes(root) == _hashes(reported.root)


def test_a_folder_without_a_run_and_one_of_another_version_are_refused(reported, tmp_path):
    with pytest.raises(OutputError, match="no run"):
        write_report(tmp_path)
    root = _copy(reported.root, tmp_path / "copy")
    run = read_record(root / "run.json")
    write_record(root / "run.json", run | {"schema": 2})
    with pytest.raises(InputError, match="schema 2"):
        write_report(root)
    write_record(root / "run.json", {"schema": 1, "config": {}})
    with pytest.raises(InputError, match="configuration"):
        write_report(root)


def test_a_missing_extra_is_named(reported, monkeypatch):
    take_away(monkeypatch, "altair", "surmount.report")
    with pytest.raises(MissingExtraError, match=r"pip install 'surmount\[report\]'"):
        write_report(reported.root)


def test_the_report_reads_artefacts_without_the_laboratory(reported):
    program = (
        "import sys; sys.modules['gymnasium'] = None; from pathlib import Path;"
        "import surmount.report.writing;"
        "from surmount.report.contents import document_of;"
        "from surmount.report.results import read_run;"
        f"document_of(read_run(Path({str(reported.root)!r})));"
        "found = {'torch', 'mujoco', 'surmount.experiment'} & set(sys.modules);"
        "sys.exit(', '.join(found) or None)"
    )
    done = subprocess.run(  # noqa: S603
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def test_templates_and_style_lie_beside_the_code():
    names = {path.name for path in (resources.files("surmount.report") / "templates").iterdir()}
    assert {"page.html.j2", "page.css", "page.js"} <= names


def test_page_of_an_analysis_is_made_from_the_record_alone(reported, tmp_path):
    record = read_record(reported.stages["analysis"].path("analysis.json"))
    page_file = write_analysis_report(record, tmp_path)
    figures = sorted((tmp_path / "figures").iterdir())
    assert {path.stem for path in figures} == {
        "figure-5-mixture-fit", "figure-6-distances-and-groups", "success-and-stability",
    }  # fmt: skip
    for path in figures:
        assert path.read_bytes() == (reported.root / "figures" / path.name).read_bytes()
    read = PageReader(page_file.read_text(encoding="utf-8"))
    assert read.problems == []
    analysis = Analysis.from_record(record)
    for sentence in (*describe_trust(analysis), *analysis.warnings):
        assert sentence in read.text
    header, links = link_table(analysis)
    assert all(cell in read.text for row in (header, *links) for cell in row)
    with pytest.raises(InputError):
        write_analysis_report({"kind": "something else"}, tmp_path)


def packed_charts(read):
    """Return specification and data of the figures of a page, by name."""
    (packed,) = [text for attributes, text in read.scripts if attributes.get("id") == "charts"]
    return json.loads(gzip.decompress(base64.b64decode(packed)))


def every_row(spec):
    return [row for rows in json.loads(spec)["datasets"].values() for row in rows]


def _parse(text):
    """Return kind and content of every token of Markdown: of links and pictures, where they go."""
    blocks = MarkdownIt("commonmark").enable("table").parse(text)
    tokens = [token for block in blocks for token in (block, *(block.children or ()))]
    return [
        (token.type, token.attrs.get("src") or token.attrs.get("href") or token.content)
        for token in tokens
        if token.type != "inline"
    ]


def _page(root, *, drawn):
    """Return the page of a run, with only some of its still figures drawn, to save time."""
    document = document_of(read_run(root))
    empty = StillFiles(spec="{}", svg=b"<svg/>", png=b"")
    stills = {
        figure.name: draw(figure.chart) if figure.name in drawn else empty
        for figure in document.figures()
    }
    assert set(drawn) <= stills.keys()
    return PageReader(page(document, stills))


def _copy(source, target):
    """Return a copy of a run folder without its report."""
    root = target / "run"
    shutil.copytree(source, root, ignore=shutil.ignore_patterns("figures", "report.*"))
    return root


def test_names_of_settings_are_code_and_nothing_else_is():
    notice = Notice(title="t", sentences=("Raise `a.b`, not `<i>` or `|`.",))
    document = Document(
        title="t", subtitle="s", notices=(notice,), summary=(), facts=(), sections=()
    )
    html = page(document, {})
    assert "Raise <code>a.b</code>, not `&lt;i&gt;` or `|`." in html
    written = markdown(document, page="p.html", figures="f")
    assert "Raise `a.b`, not \\`\\<i\\>\\` or \\`\\|\\`." in written


def test_what_scrolls_can_be_reached_by_the_keyboard(reported):
    read = PageReader(reported.text())
    scrolling = [
        attributes
        for tag, attributes in read.elements
        if tag == "div" and attributes.get("class") in {"table", "scroll"}
    ]
    assert len(scrolling) > len(FIGURES)
    assert all(attributes["tabindex"] == "0" for attributes in scrolling)
    assert all(attributes["aria-label"] for attributes in scrolling)
