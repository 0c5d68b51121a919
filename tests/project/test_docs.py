"""The documentation builds without a warning, its links resolve, and it is complete."""

from __future__ import annotations

import ast
import os
import re
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from html.parser import HTMLParser
from importlib import import_module
from pathlib import Path
from typing import Annotated, Literal
from urllib.parse import unquote

import pytest
import yaml
from pydantic import BaseModel

from wheelrail.cli.main import app
from wheelrail.scenes.quantities import RUN
from wheelrail.scenes.schema import quantities as q
from wheelrail.scenes.schema.scene import KINDS
from wheelrail.vehicle.track.irregularity import QUANTITIES

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
sys.path.insert(0, str(DOCS))

from extensions import public_names as names  # noqa: E402
from extensions import scene_keys as keys  # noqa: E402
from extensions.benchmark_list import programs  # noqa: E402
from extensions.docstrings import restructured  # noqa: E402

# The collector of cycles takes a quarter of a build's time.
SPHINX = "import gc, sys; gc.disable(); from sphinx.cmd.build import main; sys.exit(main())"
NOWHERE = "http://127.0.0.1:9"  # no server there: a build that uses the network fails


def built(sources: Path, out: Path, configured: Path) -> subprocess.CompletedProcess[str]:
    """Sphinx on a folder of sources, without a network, warnings as errors."""
    command = [sys.executable, "-c", SPHINX, "-W", "--keep-going", "-q", "-b", "html", "-c", str(configured)]
    proxies = dict.fromkeys(("http_proxy", "https_proxy", "HTTP_PROXY", "HTTPS_PROXY"), NOWHERE)
    env = {**os.environ, **proxies, "PYTHONPATH": str(ROOT), "PYTHONDONTWRITEBYTECODE": "1"}
    # Navigation by a theme, on every page, takes half of the time.
    command += ["-D", "toc_object_entries=0", "-D", "html_theme=basic"]
    command += ["-d", str(out.with_name(out.name + "-doctrees")), str(sources), str(out)]
    return subprocess.run(command, capture_output=True, text=True, env=env, cwd=ROOT, timeout=300, check=False)


def files(folder: Path) -> dict[Path, int]:
    """Files of a folder, and when they were written last."""
    return {p: p.stat().st_mtime_ns for p in folder.rglob("*") if p.is_file() and "__pycache__" not in p.parts}


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("docs") / "html"
    before = files(DOCS)
    done = built(DOCS, out, DOCS)
    assert done.returncode == 0, done.stderr
    assert files(DOCS) == before, "the build writes into the sources"
    return out


@dataclass
class Page(HTMLParser):
    """Anchors, links and resources of a page, and its text."""

    anchors: set[str] = field(default_factory=set)
    links: list[str] = field(default_factory=list)
    resources: list[str] = field(default_factory=list)
    words: list[str] = field(default_factory=list)
    equations: int = 0

    def __post_init__(self) -> None:
        super().__init__()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {key: value or "" for key, value in attrs}
        self.anchors |= {given[key] for key in ("id", "name") if key in given}
        self.equations += tag == "math"
        if tag == "a" and "href" in given:
            self.links.append(given["href"])
        elif tag in ("script", "img", "link") and (given.keys() & {"src", "href"}):
            self.resources.append(given.get("src") or given["href"])

    def handle_data(self, data: str) -> None:
        self.words.append(data)

    @property
    def text(self) -> str:
        return "".join(self.words)


@cache
def page(file: Path) -> Page:
    found = Page()
    found.feed(file.read_text(encoding="utf-8"))
    return found


def test_pages_exist_and_links_resolve(site: Path) -> None:
    wanted = [p.relative_to(DOCS).with_suffix(".html") for p in DOCS.rglob("*") if p.suffix in (".md", ".rst")]
    assert len(wanted) > 30
    assert all((site / name).is_file() for name in wanted)
    broken = []
    for file in sorted(site.rglob("*.html")):
        for link in page(file).links + page(file).resources:
            path, _, anchor = unquote(link).partition("#")
            if re.match(r"[a-z]+:", path):
                continue
            target = (file.parent / path.partition("?")[0]).resolve() if path else file
            if not target.exists() or (anchor and target.suffix == ".html" and anchor not in page(target).anchors):
                broken.append(f"{file.relative_to(site)}: {link}")
    assert not broken


def test_pages_need_no_network(site: Path) -> None:
    foreign = {r for file in site.rglob("*.html") for r in page(file).resources if re.match(r"(https?:)?//", r)}
    assert not foreign


def test_equations_are_rendered(site: Path) -> None:
    """Every equation of the sources is MathML on its page, without remaining LaTeX."""
    for source in (DOCS / "theory").glob("*.md"):
        text = source.read_text(encoding="utf-8")
        blocks = re.findall(r"^\$\$$.*?^\$\$$", text, flags=re.MULTILINE | re.DOTALL)
        inline = re.findall(r"\$[^$\n]+\$", re.sub(r"^\$\$$.*?^\$\$$", "", text, flags=re.MULTILINE | re.DOTALL))
        shown = page(site / "theory" / f"{source.stem}.html")
        assert shown.equations == len(blocks) + len(inline), source.name
        assert not re.search(r"\\[a-z]+\b|\$", shown.text), source.name


def test_unsupported_equation_ends_the_build(tmp_path: Path) -> None:
    (tmp_path / "conf.py").write_text(
        f"import sys\nsys.path.insert(0, {str(DOCS)!r})\n"
        'extensions = ["myst_parser", "extensions.mathml"]\n'
        'myst_enable_extensions = ["dollarmath"]\nhtml_math_renderer = "mathml"\n'
    )
    equations = r"\nosuchcommand{x}", r"\frac12 + \dot{x}", r"\dot\omega"
    names = [f"page{number}.md" for number in range(len(equations))]
    for name, equation in zip(names, equations, strict=True):
        (tmp_path / name).write_text(f"---\norphan: true\n---\n# Title\n\n${equation}$\n")
    (tmp_path / "index.md").write_text("# Title\n")
    done = built(tmp_path, tmp_path / "out", tmp_path)
    assert done.returncode != 0
    refused = [line for line in done.stderr.splitlines() if "equation not understood" in line]
    assert [name for name in names if any(name in line for line in refused)] == names


def test_every_public_name_is_in_the_reference(site: Path) -> None:
    pages = [page(file) for file in (site / "reference" / "python").glob("*.html")]
    assert len(pages) == len(names.TOPICS) + 1
    anchors = set().union(*(one.anchors for one in pages))
    modules = [name for chapter in names.CHAPTERS.values() for name in chapter]
    public = {f"{name}.{thing}" for name in modules for thing in names.public(import_module(name))}
    assert {"wheelrail.contact.laws.parameters.ContactLaws", "wheelrail.vehicle.simulation.simulate.simulate"} <= public
    front = import_module("wheelrail")
    assert {f"wheelrail.{name}" for name in getattr(front, "__all__", ())} <= public
    assert public <= anchors
    assert not any("ForwardRef" in one.text for one in pages)


def test_every_key_of_a_scene_has_its_row(site: Path) -> None:
    text = (site / "reference" / "scenes.html").read_text(encoding="utf-8")
    tables = keys.models(tuple(KINDS.values()))
    assert {"Contact", "RunScene", "SegmentTable", "IrregularityTable", "BlockStressTable"} <= {
        t.__name__ for t in tables
    }
    for table in tables:
        section = text.split(f'id="{table.__name__.lower()}"')[1].split("</section>")[0]
        rows = re.findall(r"<tr[^>]*>.*?</tr>", section, flags=re.DOTALL)
        shown = {found[1] for row in rows if (found := re.search(r'class="pre">(\w+)<', row))}
        assert shown == set(keys.own_keys(table)), table.__name__
    every = {key for table in tables for key in keys.own_keys(table)}
    assert every == {key for table in tables for key in table.model_fields}


STUDIES = {"StudyTable", "LatinHypercube", "Between", "Convergence"}  # tables of studies


def test_every_key_is_described() -> None:
    known = tomllib.loads(keys.SENTENCES.read_text(encoding="utf-8"))
    tables = {
        table.__name__: table for table in keys.models((*KINDS.values(), *keys.study_models(), *keys.wear_models()))
    }
    if not keys.study_models():
        known = {name: said for name, said in known.items() if name not in STUDIES}
    for name, table in tables.items():
        for key in keys.own_keys(table):
            assert keys.sentence(table, key).endswith("."), f"{name}.{key} has no sentence in {keys.SENTENCES}"
    stale = {f"{name}.{key}" for name, said in known.items() for key in said if key not in keys.own_keys(tables[name])}
    assert not stale


class Inner(BaseModel):
    """A table."""

    depth: q.Depth


class Sample(BaseModel):
    number: q.Speed
    ends: Annotated[float, q.Range(-1.0, 1.0, "m")] = 0.5
    choice: Literal["one", 2] | None = None
    pair: tuple[q.Creepage, q.Spin]
    many: tuple[Inner, ...] = ()
    named: dict[str, Inner] = {}
    flag: bool = True


def test_types_in_words() -> None:
    def of(key: str) -> keys.Kind:
        given = Sample.model_fields[key]
        return keys.kind(given.annotation, tuple(given.metadata))

    assert of("number") == keys.Kind(str(q.Range(1e-3, 200.0, "m/s", "162 km/h is 45 m/s")), "m/s")
    assert of("ends") == keys.Kind("a number from -1 to 1 m", "m")
    assert of("choice").allowed == '`"one"` or `2`'
    assert of("pair").unit == "rad/m"
    assert of("many") == keys.Kind("tables", "", (Inner,))
    assert of("named").tables == (Inner,)
    assert keys.models((Sample,)) == [Sample, Inner]
    defaults = {key: keys.default(given) for key, given in Sample.model_fields.items()}
    assert defaults["number"] == "must be given"
    assert (defaults["ends"], defaults["flag"], defaults["choice"]) == ("`0.5`", "`true`", "")


def test_every_command_and_option_is_described(site: Path) -> None:
    from typer.main import get_command

    text = page(site / "reference" / "command-line.html").text
    group = get_command(app)
    assert {"contact", "run", "compare"} <= set(group.commands)
    for name, command in group.commands.items():
        assert f"wheelrail {name}" in text
        for option in command.params:
            assert all(spelled in text for spelled in option.opts if spelled.startswith("--")), option.opts
            assert " ".join((option.help or "").split()) in " ".join(text.split())


def test_variables_of_runs_are_listed(site: Path) -> None:
    text = page(site / "reference" / "results.html").text
    wanted = {
        *(name for name, declared in RUN.items() if declared.needed),
        "t_gamma",
        "mechanical_energy",
        "yaw_reaction",
    }
    assert {name for name in wanted if not re.search(rf"\b{name}\b", text)} == set()
    assert all(f"irregularity_{name}" in text for name in QUANTITIES)


def test_every_benchmark_is_listed(site: Path) -> None:
    text = page(site / "benchmarks.html").text
    assert {"accuracy", "curve", "error_vs_time"} <= set(programs())
    assert all(f"benchmarks.{name}" in text and what for name, what in programs().items())


def test_commands_of_benchmarks_exist() -> None:
    pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *DOCS.rglob("*.md")]
    text = "".join(file.read_text(encoding="utf-8") for file in pages)
    commands = set(re.findall(r"python -m benchmarks\.([\w.]+)", text)) - {"NAME"}
    assert len(commands) > 5
    assert commands <= set(programs())


def code_names() -> Iterator[tuple[str, str]]:
    """Page and dotted name of everything of this package that the pages name as code."""
    packages = "wheelrail|benchmarks|meshes|forms|contact|vehicle|scenes"
    for source in sorted(DOCS.rglob("*.md")):
        for name in re.findall(rf"`((?:{packages})(?:\.\w+)+)`", source.read_text(encoding="utf-8")):
            if not name.endswith((".toml", ".nc", ".py", ".h", ".hpp", ".f90")):
                yield source.name, name


def test_files_and_functions_named_in_the_text_exist() -> None:
    found = set(code_names())
    assert len(found) > 60
    missing = []
    for source, name in found:
        parts = name.split(".")
        depth = next((n for n in range(len(parts), 1, -1) if (ROOT / Path(*parts[:n])).with_suffix(".py").exists()), 0)
        if not depth:
            missing.append(f"{source}: {name}")
            continue
        tree = ast.parse((ROOT / Path(*parts[:depth])).with_suffix(".py").read_text(encoding="utf-8"))
        defined = {getattr(node, "name", getattr(node, "id", None)) for node in ast.walk(tree)}
        defined |= {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
        missing += [f"{source}: {name}" for part in parts[depth:] if part not in defined]
    assert not missing


def test_scenes_in_the_text_are_valid_tables(tmp_path: Path) -> None:
    """Keys of TOML in the how-to pages are keys of scenes, or of the wagon; vehicle files are complete."""
    from dataclasses import fields

    from wheelrail.contact.laws.registry import FRICTION, NORMAL
    from wheelrail.scenes.builders.vehicle_file import load_vehicle
    from wheelrail.scenes.schema.irregularity_file import NAMES
    from wheelrail.scenes.wear.schema import check_wear
    from wheelrail.vehicle.wagon.components import Suspension
    from wheelrail.vehicle.wagon.wagon import Wagon

    tables = keys.models((*KINDS.values(), *keys.wear_models()))
    allowed = {key for table in tables for key in table.model_fields}
    laws = [law for law in (*FRICTION.values(), *NORMAL.values()) if isinstance(law, type)]
    own = {"dry", "wheelset_1", "wheelset_4", "turned", "hollow"}  # a law in laws.md, names in flexible.md, vehicle.md
    allowed |= {item.name for thing in (Wagon, Suspension, *laws) for item in fields(thing)} | own | set(NAMES)
    seen = set()
    for source in (DOCS / "how-to").glob("*.md"):
        for block in re.findall(r"^```toml\n(.*?)^```", source.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL):
            given = tomllib.loads(block)
            if {"bodies", "vehicles"} & set(given):  # a vehicle file
                shutil.copy(ROOT / "scenes" / "freight_wagon.toml", tmp_path)
                (tmp_path / "vehicle.toml").write_text(block, encoding="utf-8")
                assert load_vehicle(tmp_path / "vehicle.toml").bodies
            elif given.get("kind") == "wear":
                assert check_wear(given, ROOT / "scenes" / "wear.toml").duty
            elif given.get("kind") != "study":
                seen |= set(_keys(given))
    assert len(seen) > 20
    assert seen <= allowed


def _keys(table: object) -> Iterator[str]:
    if isinstance(table, dict):
        for key, value in table.items():
            yield key
            yield from _keys(value)
    elif isinstance(table, list):
        for item in table:
            yield from _keys(item)


def test_docstrings_are_text() -> None:
    lines = [
        "Norm |x| of x_i * y <z> and `name`.",
        "",
        "More text",
        "goes on:",
        "",
        "    indented_code *",
        "",
        ">>> f(x)",
    ]
    found = restructured(lines)
    assert found[0] == r"Norm \|x\| of x\_i \* y \<z\> and ``name``."
    assert found.count("::") == 2
    assert "        indented_code *" in found
    assert "    >>> f(x)" in found


def test_links_of_the_front_page_resolve() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    links = [link for link in re.findall(r"\]\(([^)#]+)\)", readme) if "://" not in link]
    assert {"docs/validation.md", "docs/limits.md", "CONTRIBUTING.md"} <= set(links)
    assert all((ROOT / link).exists() for link in links)


def paragraphs(text: str) -> Iterator[str]:
    """Paragraphs and entries of lists of a page in Markdown, without code, equations, tables and headings."""
    text = re.sub(r"^(```|:::|\$\$).*?^\1$", "\n", text, flags=re.MULTILINE | re.DOTALL)
    for block in re.split(r"\n\s*\n|\n(?=\s*(?:[-*]|\d+\.) )", text):
        yield "\n".join(line for line in block.splitlines() if not re.match(r"\s*(\||#|<!--|%)", line))


def test_paragraphs_are_short() -> None:
    """Outside the theory, whose arguments need more."""
    pages = [p for p in sorted(DOCS.rglob("*.md")) if p.relative_to(DOCS).parts[0] != "theory"]
    pages += [ROOT / "README.md", ROOT / "CONTRIBUTING.md"]
    long = {
        f"{file.name}: {words} words: {text.strip()[:60]}"
        for file in pages
        for text in paragraphs(file.read_text(encoding="utf-8"))
        if (words := len(text.split())) > 120
    }
    assert len(pages) > 30
    assert not long
    sample = "# T\n\na b\nc\n\n- d e\n- f\n| g |\n\n```sh\nh\n```\n\ni"
    assert [len(text.split()) for text in paragraphs(sample) if text.strip()] == [3, 3, 2, 1]


def test_limits_are_brief() -> None:
    """A bold sentence for each, and at most two further lines."""
    entries = re.findall(r"^- (.*(?:\n  .*)*)", (DOCS / "limits.md").read_text(encoding="utf-8"), flags=re.MULTILINE)
    assert len(entries) > 20
    assert [entry for entry in entries if not entry.startswith("**") or entry.count("\n") > 2] == []


def test_changelog_is_one_line_for_each_change() -> None:
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert len(text.encode()) < 15_000
    for line in text.splitlines():
        assert len(line) <= 160, line
        assert not line or line.startswith(("- ", "#")) or line[0].isupper(), f"not an entry of one line: {line}"


# https://github.com/citation-file-format/citation-file-format, schema 1.2.0: required keys, and the others that we use.
CFF_REQUIRED = {"cff-version", "message", "title", "authors"}
CFF_OPTIONAL = {"abstract", "date-released", "keywords", "license", "references", "type", "version"}
REFERENCE_REQUIRED = {"type", "title", "authors"}
REFERENCE_OPTIONAL = {"doi", "end", "issue", "journal", "start", "volume", "year"}


def test_citation_file() -> None:
    found = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert found["cff-version"] == "1.2.0"
    assert CFF_REQUIRED <= set(found) <= CFF_REQUIRED | CFF_OPTIONAL
    assert found["type"] == "software"
    for reference in found["references"]:
        assert REFERENCE_REQUIRED <= set(reference) <= REFERENCE_REQUIRED | REFERENCE_OPTIONAL
        assert reference["type"] in ("article", "conference-paper")
        assert all(author.keys() == {"family-names", "given-names"} for author in reference["authors"])
    (article,) = (r for r in found["references"] if r["type"] == "article")
    page_of_it = (DOCS / "citing.md").read_text(encoding="utf-8")
    assert f"https://doi.org/{article['doi']}" in page_of_it
    assert f"{article['start']}-{article['end']}" in page_of_it


def test_reference_has_sources_and_tables_of_parameters(site: Path) -> None:
    files = sorted((site / "reference" / "python").glob("*.html"))
    text = "".join(file.read_text(encoding="utf-8") for file in files)
    assert text.count("parameters docutils") + text.count('class="parameters') > 100
    links = [link for file in files for link in page(file).links]
    sources = {link for link in links if link.startswith("../../_modules/wheelrail/")}
    assert any("solution.html#" in link for link in sources)
    assert len(sources) > 200


def test_parameters_become_a_table() -> None:
    lines = [
        "Solve.",
        "",
        "Parameters:",
        "    y, z: position, m;",
        "        upwards.",
        "    load: N.",
        "",
        "Returns |F|.",
    ]
    assert restructured(lines)[2:] == [
        "**Parameters**",
        "",
        ".. list-table::",
        "   :class: parameters",
        "",
        "   * - ``y``, ``z``",
        "     - position, m; upwards.",
        "   * - ``load``",
        "     - N.",
        "",
        "Returns \\|F\\|.",
        "",
    ]


def test_displayed_equations_of_the_theory_are_numbered(site: Path) -> None:
    for file in (site / "theory").glob("*.html"):
        text = file.read_text(encoding="utf-8")
        numbers = [int(number) for number in re.findall(r'<span class="eqno">\((\d+)\)', text)]
        assert numbers == list(range(1, len(numbers) + 1)), file
        assert len(numbers) == text.count('class="equation"'), file
    assert "eqno" in (site / "theory" / "lattice.html").read_text(encoding="utf-8")


def test_names_of_modules_are_links(site: Path) -> None:
    links = page(site / "how-to" / "element.html").links + page(site / "theory" / "stress-wear.html").links
    assert any("reference/python/" in link and "wheelrail.contact" in link for link in links)
