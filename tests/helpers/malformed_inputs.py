"""Invalid input by command: files to write, the command, and the required parts of its error message."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from wheelrail.meshes.profiles.named import named_profile

SCENES = Path(__file__).parents[2] / "scenes"
HERTZ, WHEELSET, CURVE, IRREGULAR = (
    (SCENES / f"{name}.toml").read_text() for name in ("hertz", "wheelset", "paper_curve", "irregular")
)
RAIL_NAME = 'rail = "UIC60-benchmark"'
CONTACT, RUN = ("contact", "scene.toml"), ("run", "scene.toml", "--out", "out")
STUDY = 'kind = "study"\nscene = "scene.toml"\n'
PNG = b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR\x00\x00\x01\x00" + bytes(range(256))
MB = 2**20


@dataclass(frozen=True)
class Case:
    """name; command; files by name, as content or as a function that creates them; says: parts of the single error
    message.
    """

    name: str
    says: tuple[str, ...]
    files: Mapping[str, str | bytes | Callable[[Path], None]]
    command: tuple[str, ...] = CONTACT

    def write(self, folder: Path) -> None:
        for name, content in self.files.items():
            if callable(content):
                content(folder / name)
            else:
                (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)


@dataclass
class Table:
    """Cases, one call each."""

    cases: list[Case] = field(default_factory=list)

    def add(self, name: str, says: tuple[str, ...], files: Mapping[str, object], command: tuple[str, ...]) -> None:
        self.cases.append(Case(name, says, files, command))  # type: ignore[arg-type]

    def file(self, name: str, content: object, *says: str) -> None:
        """A scene file as it is."""
        self.add(name, ("scene.toml", *says), {"scene.toml": content}, CONTACT)

    def scene(self, name: str, text: str, old: str, new: str, *says: str) -> None:
        """A shipped scene with one place changed."""
        command = RUN if 'kind = "run"' in text else CONTACT
        self.add(name, ("scene.toml: ", *says), {"scene.toml": changed(text, old, new)}, command)

    def profile(self, name: str, file: str, content: object, *says: str) -> None:
        """A profile file in the scene of a wheelset; its name begins with what it is of."""
        old, what = ('wheel = "S1002"', "wheel") if file.startswith("wheel") else (RAIL_NAME, "rail")
        text = changed(standard(WHEELSET), old, f'{what} = "{file}"')
        self.add(name, ("scene.toml: profiles", f"{what}", *says), {"scene.toml": text, file: content}, CONTACT)

    def uneven(self, name: str, content: object, *says: str) -> None:
        """A file of irregularities."""
        text = changed(IRREGULAR, 'spectrum = "low"', 'file = "uneven.csv"')
        text = changed(changed(text, "seed = 1\n", ""), "wavelengths = [3.0, 100.0]", "")
        files = {"scene.toml": text, "uneven.csv": content}
        self.add(name, ("scene.toml: track.irregularities.", *says), files, ("track", "scene.toml"))

    def wagon(self, name: str, content: object, *says: str) -> None:
        self.add(name, ("wagon.toml", *says), {"wagon.toml": content}, ("wagon", "wagon.toml"))

    def study(
        self, name: str, text: str, *says: str, scene: str = HERTZ, where: str = "study.toml", **files: object
    ) -> None:
        """A study of scene.toml."""
        text = text if text.startswith("kind") or not text.strip() else STUDY + text
        command = ("study", "study.toml", "--out", "out")
        self.add(f"study: {name}", (where, *says), {"scene.toml": scene, "study.toml": text, **files}, command)

    def option(self, name: str, command: tuple[str, ...], says: tuple[str, ...], **files: object) -> None:
        scene = {"scene.toml": standard(CURVE if command[0] != "contact" else WHEELSET)}
        self.add(name, says, {**scene, **files}, command)


def changed(text: str, old: str, new: str) -> str:
    assert old in text, old
    return text.replace(old, new, 1)


def standard(text: str) -> str:
    """The scene with the quick contact model."""
    return changed(text, 'model = "condensed"', 'model = "standard"')


def rows(points: np.ndarray, separator: str = " ") -> list[str]:
    """Lines of a text file, mm."""
    return [f"{1e3 * y:.6f}{separator}{1e3 * z:.6f}" for y, z in points]


def along(name: str, start: float, stop: float, step: float = 0.5e-3) -> np.ndarray:
    return named_profile(name).point(np.arange(start, stop, step))


WHEEL = along("S1002", -0.075, 0.06)
RAIL = along("60E1", -0.05, 0.05)


def lines(points: np.ndarray, at: int | None = None, new: str = "") -> str:
    """A profile file, one of whose lines (counted from 1) may be another."""
    found = rows(points)
    if at is not None:
        found[at - 1] = new
    return "\n".join(found) + "\n"


def folder(path: Path) -> None:
    path.mkdir()


def pipe(path: Path) -> None:
    import os

    os.mkfifo(path)


def nowhere(path: Path) -> None:
    path.symlink_to(path.parent / "gone")


def endless(path: Path) -> None:
    path.symlink_to("/dev/zero")


def sparse(size: int) -> Callable[[Path], None]:
    """File of zeros that occupies no disk space."""

    def make(path: Path) -> None:
        with path.open("wb") as file:
            file.truncate(size)

    return make


def grown(line: str, count: int) -> Callable[[Path], None]:
    """A file of so many lines, each with its number in it."""

    def make(path: Path) -> None:
        path.write_text("".join(line.format(i) for i in range(count)))

    return make


def places() -> Iterator[tuple[str, object, str]]:
    """Paths that are no regular files: name, content, message."""
    yield "folder", folder, "folder"
    yield "pipe", pipe, "pipe"
    yield "link to nowhere", nowhere, "No such file"
    yield "device", endless, "device"


def scene_files(t: Table) -> None:
    t.file("empty", "", "kind: missing", "'hertz', 'wheelset', 'run'")
    t.file("blank", "\n\n# nothing\n", "kind: missing")
    t.file("truncated table", HERTZ[: HERTZ.index("[lower]") + 4], "not valid TOML", "end of document")
    t.file("truncated value", HERTZ[: HERTZ.index("10.0") - 1], "not valid TOML")
    t.file("picture", PNG, "UTF-8")
    t.file("UTF-16", HERTZ.encode("utf-16"), "UTF-16", "UTF-8")
    t.file("Latin-1", HERTZ.replace("Two", "Zwei Körper", 1).encode("latin-1"), "line 1", "UTF-8")
    t.file("zeros", sparse(4096), "line 1")
    t.file("huge", sparse(2**40), "1.1e+06 MB", "1 MB")
    t.file("a million numbers", HERTZ + "[more]\nx = [" + "1," * MB + "]", "MB")
    t.file("nested too deep", HERTZ + "x = " + "[" * 20000 + "]" * 20000, "not valid TOML", "nested")
    t.file("number too long", HERTZ.replace("10e3", "1" * 5000), "not valid TOML", "digits")
    t.file("hexadecimal number too long", HERTZ.replace("10e3", "0x" + "f" * 200_000), "load", "800000 bits")
    t.file("dots", "a" + ".a" * 30_000 + " = 1\n", "line 1", "at most 32 dots")
    t.file("nested 100 levels", HERTZ + "x = " + "[" * 100 + "]" * 100, "nested more than 32 levels")
    t.file("key too long", "k" * 500_000 + " = 1\n" + HERTZ, "kkk...", "unknown key")
    t.file("kind too long", HERTZ.replace('"hertz"', f'"{"x" * 500_000}"'), "kind = 'xxx", "'run'")
    unknown = "".join(f"k{i} = 1\n" for i in range(60_000))
    t.file("60 000 unknown keys", unknown + HERTZ, "k1 = 1: unknown key", "59996 more errors")
    t.file("number too large", HERTZ.replace("10e3", "1" + "0" * 400), "load = 1000", "1e+08 N")
    t.file("JSON", '{"kind": "hertz"}', "not valid TOML", "line 1")
    t.file("kind of no kind", 'kind = ["run"]', "kind = ['run']", "'run'")
    for name, content, says in places():
        t.file(name, content, "cannot be read", says)


def hertz_scenes(t: Table) -> None:
    for name, old, new, *says in (
        ("load missing", "load = 10e3", "", "load: missing", "exactly one"),
        ("load in GN", "load = 10e3", "load = 10e9", "load = 10000000000.0", "1e+08 N"),
        ("load NaN", "load = 10e3", "load = nan", "load = NaN", "N"),
        (
            "depths without end",
            "[upper]",
            f"[stress]\ndepths = {[1e-3] * 2000}\n[upper]",
            "2000 values",
            "at most 1000",
        ),
        ("load of nothing", "load = 10e3", "load = 1e-300", "load = 1e-300", "0.001"),
        ("approach of nothing", "load = 10e3", "approach = 1e-300", "approach = 1e-300", "1e-10 to 0.005 m"),
        ("speed of nothing", "speed = 10.0", "speed = 1e-300", "speed = 1e-300", "0.001 to 200 m/s"),
        ("slip_order as truth value", "load = 10e3", "load = 10e3\nslip_order = true", "slip_order = true", "1 or 2"),
        ("slip_order as fraction", "load = 10e3", "load = 10e3\nslip_order = 2.0", "slip_order = 2.0", "1 or 2"),
        ("load as text", "load = 10e3", 'load = "10 kN"', 'load = "10 kN"', "a number"),
        ("load as date", "load = 10e3", "load = 1998-05-03", "load = ", "a number"),
        ("friction in per cent", "friction = 0.3", "friction = 30", "friction = 30", "0 to 2"),
        ("speed in mm/s", "speed = 10.0", "speed = 10000", "speed = 10000", "200 m/s"),
        ("creepage per mille", "[1e-3, 0.0, 0.0]", "[1.2, 0.0, 0.0]", "creepage[0] = 1.2", "-1 to 1"),
        ("creepage NaN", "[1e-3, 0.0, 0.0]", "[1e-3, nan, 0.0]", "creepage[1] = NaN"),
        ("creepage short", "[1e-3, 0.0, 0.0]", "[]", "creepage"),
        ("mesh of nanometres", "0.5e-3", "1e-9", "surface_size = 1e-09", "5e-05 to 0.01 m"),
        ("mesh in mm", "surface_size = 0.5e-3", "surface_size = 0.5", "surface_size = 0.5", "0.5e-3"),
        ("strips beyond memory", "# strips = 12", "strips = 1000000", "strips = 1000000", "4 to 64"),
        ("E in GPa", "E = 210e9", "E = 210", "upper.E = 210", "GPa"),
        ("E in MPa", "E = 210e9", "E = 210e3", "upper.E = 210000", "MPa"),
        ("nu of no steel", "nu = 0.3", "nu = 30", "upper.nu = 30", "-1 and 0.5"),
        ("radii in mm", "radii = [0.46, 0.3]", "radii = [460, 300]", "upper.radii[0] = 460", "100 m"),
        ("radius of zero", "radii = [0.46, 0.3]", "radii = [0, 0.3]", "upper.radii[0] = 0"),
        ("body missing", "[lower]", "[bottom]", "bottom", "unknown key", "lower: missing"),
        ("body under another name", "[lower]", "[below]", "unknown key; did you mean lower?"),
        ("table as number", "[upper]", "lower = 3\n[upper]", "not valid TOML"),
        ("depth in mm", "[upper]", "[stress]\ndepths = [2.0]\n[upper]", "stress.depths[0] = 2.0", "2e-3"),
    ):
        t.scene(f"pair: {name}", HERTZ, old, new, *says)


def wheelset_scenes(t: Table) -> None:
    t.scene("wheelset: nu of auxetics", standard(WHEELSET), "nu = 0.3", "nu = -0.2", "nu = -0.2", "at least 0")
    for name, old, new, *says in (
        ("gauge in mm", "gauge = 1.435", "gauge = 1435", "track.gauge = 1435", "0.5 to 2 m"),
        ("gauge in km", "gauge = 1.435", "gauge = 1.435e-3", "track.gauge = 0.001435", "0.5 to 2 m"),
        ("gauge height in mm", "gauge_height = 0.014", "gauge_height = 14", "track.gauge_height = 14", "0.014"),
        ("wheel radius in mm", "radius = 0.46", "radius = 460", "wheelset.radius = 460", "0.1 to 1 m"),
        ("diameter as radius", "radius = 0.46", "radius = 1.2", "wheelset.radius = 1.2", "0.46"),
        ("place in mm", "y = -0.002", "y = -2.0", "wheelset.y = -2.0", "0.002"),
        ("yaw in degrees", "yaw = 0.0", "yaw = 1.5", "wheelset.yaw = 1.5", "rad"),
        ("wheel load in mN", "wheel_load = 57e3", "wheel_load = 57e6", "wheelset.wheel_load = 57000000", "N"),
        ("back in mm", "1.360 ", "1360 ", "flange_back_distance = 1360", "1.360"),
        ("turns per minute", "97.82608695652173", "934", "pitch_rate = 934", "pure rolling"),
        ("curve radius as curvature", "curvature = 0.0", "curvature = 300.0", "track.curvature = 300", "1/radius"),
        ("wheels wider than the track", "1.360 ", "1.9 ", "wheelset.flange_back_distance = 1.9", "gauge"),
        ("profile that is nowhere", '"S1002"', '"S1003.prw"', 'profiles.wheel = "S1003.prw"', "S1002", "existing file"),
        ("rail for a wheel", '"S1002"', '"60E1"', 'profiles.wheel = "60E1"', "S1002"),
        ("profile as number", '"S1002"', "1002", "profiles.wheel = 1002", "a string"),
        ("profile in lower case", '"S1002"', '"s1002"', 'profiles.wheel = "s1002"', "did you mean S1002?"),
        ("curve radius", "curvature = 0.0", "radius = 300.0", "track.radius = 300.0", "track.curvature = 1/radius?"),
        ("diameter", "radius = 0.46", "diameter = 0.92", "wheelset.diameter = 0.92", "wheelset.radius, half of it?"),
        ("key in another table", "y = -0.002", "gague = 1.435", "wheelset.gague = 1.435", "did you mean track.gauge?"),
    ):
        t.scene(f"wheelset: {name}", WHEELSET, old, new, *says)


def run_scenes(t: Table) -> None:
    for name, old, new, *says in (
        ("no end of samples", "interval = 0.0", "interval = 1e-12", "output.interval = 1e-12", "samples"),
        ("interval in ms", "interval = 0.0", "interval = 20.0", "output.interval = 20.0", "10 s"),
        ("speed 1000 times", "speed = 45.0", "speed = 45e3", "vehicle.speed = 45000", "162 km/h"),
        ("speed of a glacier", "speed = 45.0", "speed = 1e-300", "vehicle.speed = 1e-300", "0.1"),
        ("no speeds", "speed = 45.0", "speed = []", "vehicle.speed = []"),
        ("speeds without end", "speed = 45.0", f"speed = {[[i, 45.0] for i in range(10_001)]}", "at most 10000"),
        ("speeds NaN", "speed = 45.0", "speed = [[0.0, 45.0], [nan, 45.0]]", "vehicle.speed[1][0] = NaN"),
        ("curve to the moon", "curve = 200.0", "curve = 1e12", "track.curve = 1000000000000", "100000 m"),
        ("length NaN", "curve = 200.0", "curve = nan", "track.curve = NaN", "m"),
        ("cant in mm", "cant = 0.06 ", "cant = 60 ", "track.cant = 60", "60 mm is 0.06"),
        ("tolerance of nothing", "rtol = 1e-3", "rtol = 0", "solver.rtol = 0", "1e-12"),
        ("workers", "rtol = 1e-3", "rtol = 1e-3\nworkers = 200", "solver.workers = 200", "1 to 64"),
        ("workers as truth value", "rtol = 1e-3", "rtol = 1e-3\nworkers = true", "solver.workers = true", "1 to 64"),
        ("profile name too long", '"S1002"', f'"{"x" * 100_000}"', "profiles.wheel = ", "existing file"),
        ("wagon name too long", "speed = 45.0", f'speed = 45.0\nwagon = "{"x" * 100_000}"', "wagon", "too long"),
        ("wagon key too long", "speed = 45.0", f"speed = 45.0\n{'x' * 100_000} = 1", "vehicle.xxx", "unknown key"),
        ("wagon mass in t", "speed = 45.0", "speed = 45.0\ncar_body.mass = 32", "vehicle.car_body.mass = 32", "kg"),
        ("wagon that is nowhere", "speed = 45.0", 'speed = 45.0\nwagon = "none.toml"', "none.toml", "No such file"),
        ("table for a number", "speed = 45.0", "speed = {x = 1}", "vehicle.speed", "m/s"),
        ("array for a table", "[solver]", "[[solver]]", "solver", "method"),
    ):
        t.scene(f"run: {name}", CURVE, old, new, *says)
    comma = changed(CURVE, "cant = 0.06 ", "cant = 0,06 ")
    t.add("run: decimal comma", ("scene.toml, line", "0,06", "decimal point: 0.06"), {"scene.toml": comma}, RUN)
    for name, old, new, *says in (
        ("segments of no number", "length = 20.0", 'length = "20"', "track.segments[0].length", "m"),
        ("radius in km", "radius = 800.0", "radius = 0.8", "track.segments[2].radius = 0.8", "at least 15"),
        ("waves in mm", "[3.0, 100.0]", "[3000.0, 100000.0]", "irregularities.wavelengths[0] = 3000", "m"),
        ("seed as a fraction", "seed = 1", "seed = 1.5", "irregularities.seed = 1.5"),
        ("spectrum of no class", '"low"', '"medium"', "irregularities.spectrum", '"low"'),
    ):
        t.scene(f"run: {name}", IRREGULAR, old, new, *says)
    far = IRREGULAR.replace("length = 20.0", "length = 1e5").replace("[3.0,", "[0.1,")
    says = ("scene.toml: ", "track.segments", "100000 m")
    t.add("run: segments to the moon", says, {"scene.toml": far.replace("length = 40.0", "length = 1e5")}, RUN)
    many = CURVE.replace("[track]", "[track]\nsegments = [" + 2000 * '{kind = "tangent", length = 1.0}, ' + "]")
    t.add("run: segments without end", ("track.segments", "2000 values", "at most 1000"), {"scene.toml": many}, RUN)
    fine = IRREGULAR.replace("length = 60.0", "length = 99000").replace("[3.0,", "[0.1,")
    says = ("scene.toml: ", "track.irregularities.wavelengths", "waves")
    t.add("run: waves beyond memory", says, {"scene.toml": fine}, RUN)


def profiles(t: Table) -> None:
    t.profile("wheel: empty", "wheel.txt", "", "0 points", "10")
    t.profile("wheel: header alone", "wheel.txt", "# units: mm\ny z\n", "0 points")
    t.profile("wheel: two points", "wheel.txt", "0 0\n10 1\n", "2 points", "10")
    t.profile("wheel: infinite", "wheel.txt", lines(WHEEL, 7, "1e999 3.0"), "line 7", "finite")
    t.profile("wheel: word", "wheel.txt", lines(WHEEL, 7, "12.0 twelve"), "line 7", "twelve", "finite numbers")
    t.profile("wheel: truncated line", "wheel.txt", lines(WHEEL)[:-12], "line 270", "2 or more")
    t.profile("wheel: a mark", "wheel.txt", lines(WHEEL, 7, "-9999 -9999"), "line 7", "-9999", "no coordinate")
    metres = "# units: mm\n" + lines(1e-3 * WHEEL)
    t.profile("wheel: in metres", "wheel.txt", metres, "line 2", "look like metres", "10 .. 400 mm")
    says = "look like millimetres"
    t.profile("wheel: mm as metres", "wheel.txt", "# units: m\n" + lines(WHEEL), "line 2", says, "mm")
    t.profile("wheel: heights in metres", "wheel.txt", lines(WHEEL * (1, 1e-3)), "line 1", "height", "metres")
    t.profile("wheel: rail in its place", "wheel.prr", "point.begin\n", "holds a rail", "a wheel")
    t.profile("wheel: unsorted", "wheel.txt", lines(WHEEL[::7][[*range(9, 30), *range(9)]]), "line", "steps back")
    shuffled = np.random.default_rng(1).permutation(WHEEL)
    t.profile("wheel: shuffled", "wheel.txt", lines(shuffled), "line", "y in order")
    t.profile("wheel: doubled file", "wheel.txt", lines(WHEEL) * 2, "line 271", "steps back")
    circle = (f"{3 * np.cos(a):.3f} {9 + 3 * np.sin(a):.3f}" for a in np.linspace(0.0, 6.0, 30))
    loop = "\n".join([*rows(WHEEL)[:150], *circle, *rows(WHEEL)[150:]])
    t.profile("wheel: crossing itself", "wheel.txt", loop, "line", "y in order")
    t.profile("wheel: one point many times", "wheel.txt", "1.0 2.0\n" * 50, "1 different points")
    t.profile("wheel: furlongs", "wheel.txt", "# units: furlong\n" + lines(WHEEL), "line 1", "furlong", "mm")
    t.profile("wheel: picture", "wheel.txt", PNG, "not a text file")
    t.profile("wheel: picture as MiniProf", "wheel.whl", PNG, "not a text file")
    t.profile("wheel: suffix", "wheel.xlsx", PNG, "'.xlsx'", ".csv")
    t.profile("wheel: 200 MB", "wheel.txt", sparse(200 * MB), "210 MB", "at most")
    t.profile("wheel: a million lines", "wheel.txt", "0.1 0.2\n" * MB, "8.39 MB", "at most")
    t.profile("wheel: too many points", "wheel.txt", grown("{} 0\n", 50_001), "50001 points", "20000")
    t.profile("wheel: long line", "wheel.txt", lines(WHEEL, 7, "x " * 100_000), "line 7", "'x x x", "numbers")
    t.profile("wheel: columns missing", "wheel.whl", "ColumnDef=A,B\n\n1 2\n", "line 1", "ColumnDef", "X and Y")
    t.profile("wheel: Simpack, truncated", "wheel.prw", "header.begin\ntype = 1\n", "not closed", "header.end")
    t.profile("wheel: Simpack, a value", "wheel.prw", "header.begin\ntype = x\nheader.end\n", "line 2", "x")
    t.profile("rail: one column", "rail.txt", "\n".join(str(i) for i in range(50)), "line 1", "2 or more")
    t.profile("rail: no gauge side", "rail.txt", lines(RAIL[RAIL[:, 0] > -0.02]), "gauge side", "0.014 m")
    t.profile("rail: mirrored", "rail.txt", lines(RAIL[RAIL[:, 0] > -0.02]), "mirrored")
    t.profile("rail: wheel in its place", "rail.whl", "1 2\n", "holds a wheel", "a rail")
    for name, content, says in places():
        if name != "link to nowhere":
            t.profile(f"rail: {name}", "rail.txt", content, "cannot be read", says)
    t.profile("rail: link to nowhere", "rail.txt", nowhere, "an existing file")


def irregularities(t: Table) -> None:
    good = "s, level [mm]\n" + "".join(f"{s}, 1.0\n" for s in range(200))
    t.uneven("uneven: empty", "", "0 rows", "at least 2")
    t.uneven("uneven: header alone", "s, level\n", "0 rows")
    t.uneven("uneven: truncated", good[:-5], "row 201", "level = ''")
    t.uneven("uneven: NaN", good.replace("7, 1.0", "7, nan", 1), "row 9", "level = 'nan'", "finite")
    t.uneven("uneven: mm as m", good.replace(" [mm]", ""), "row 2", "level = 1.0", "2 mm is 0.002")
    t.uneven("uneven: unit", good.replace("mm", "inch"), "row 1", "inch", "m or mm")
    t.uneven("uneven: column", good.replace("level", "height"), "row 1", "height", "cross_level")
    t.uneven("uneven: backwards", good.replace("\n7,", "\n3,", 1), "row 9", "s = 3", "greater than 6")
    t.uneven("uneven: stations in mm", good.replace("s,", "s [mm],", 1), "irregularities.fade", "0.199 m", "two fades")
    far = "s, level\n" + "".join(f"{12000 + s}, 0.001\n" for s in range(200))
    t.uneven("uneven: chainage of the line", far, "irregularities.file", "begins at 12000 m", "behind the track")
    t.uneven("uneven: picture", PNG, "not a text file")
    mixed = good.replace(", ", ";").replace("\n7;1.0", "\n7;1,0", 1)
    t.uneven("uneven: a decimal comma among points", mixed, "row 9", "level = '1,0'", "point")
    t.uneven("uneven: huge", sparse(2**35), "3.44e+04 MB", "at most")
    t.uneven("uneven: a million rows", "1,0,0,0,0,0\n" * MB, "12.6 MB", "at most")
    for name, content, says in places():
        t.uneven(f"uneven: {name}", content, "cannot be read", says)


def wagons(t: Table) -> None:
    t.wagon("wagon: unknown key", "mass = 3\n", "mass = 3", "car_body")
    t.wagon("wagon: body in t", "[car_body]\nmass = 32.0\n", "car_body.mass = 32", "kg")
    t.wagon("wagon: body in g", "[car_body]\nmass = 32e9\n", "car_body.mass = 32000000000", "kg")
    t.wagon("wagon: height in mm", "[car_body]\nheight = 1800\n", "car_body.height = 1800", "m")
    t.wagon("wagon: wheelset in mm", "[wheelset]\nheight = 460\n", "wheelset.height = 460", "m")
    t.wagon("wagon: stiffness in MN/m", "[primary]\nvertical_stiffness = 1.22\n", "vertical_stiffness = 1.22", "N/m")
    t.wagon("wagon: stiffness too large", "[primary]\nvertical_stiffness = 1.2e12\n", "= 1200000000000", "N/m")
    t.wagon("wagon: NaN", "[bogie]\nmass = nan\n", "bogie.mass = NaN", "finite")
    t.wagon("wagon: infinite", "roll_bar = inf\n", "roll_bar = Infinity", "finite")
    t.wagon("wagon: beyond floats", "roll_bar = 1" + "0" * 400, "roll_bar = 1000", "a number")
    t.wagon("wagon: dots", "bogie" + ".x" * 30_000 + " = 1\n", "line 1", "at most 32 dots")
    t.wagon("wagon: hexadecimal", "bogie.mass = 0x" + "f" * 5000, "bogie", "20000 bits")
    t.wagon("wagon: text", '[bogie]\nmass = "2.6 t"\n', 'bogie.mass = "2.6 t"', "a number")
    t.wagon("wagon: number for a table", "bogie = 2615.0\n", "bogie = 2615", "table")
    t.wagon("wagon: bumpstop that falls", "bumpstop = [[0, 0], [0.1, 5], [0.2, 3]]\n", "bumpstop", "do not decrease")
    t.wagon("wagon: bumpstop in mm", "bumpstop = [[0, 0], [25, 0], [65, 230e3]]\n", "bumpstop", "m")
    t.wagon("wagon: bumpstop NaN", "bumpstop = [[0, 0], [nan, 5]]\n", "bumpstop", "finite")
    t.wagon("wagon: gravity of another unit", "gravity = 981.0\n", "gravity = 981", "m/s2")
    t.wagon("wagon: truncated", "[car_body\n", "not valid TOML", "line 1")
    t.wagon("wagon: Latin-1", "# Güterwagen\n".encode("latin-1"), "line 1", "UTF-8")
    for name, content, says in places():
        t.wagon(f"wagon: {name}", content, "cannot be read", says)


def studies(t: Table) -> None:
    loads = "[grid]\nload = [1e4, 2e4]\n"
    t.study("empty", "", "scene: missing")
    t.study("truncated", "[grid]\nload = [1e4,", "not valid TOML")
    t.study("nothing varied", "workers = 2\n", "nothing is varied", "[grid]")
    t.study("empty grid", "[grid]\n", "grid: nothing is varied")
    t.study("no values", "[grid]\nload = []\n", "grid.load = []", "at least one")
    t.study("a value, no array", "[grid]\nload = 1e4\n", "grid.load = 10000.0", "an array")
    t.study("table of no name", "[gird]\nload = [1e4]\n", "gird: unknown key; did you mean grid?")
    t.study("wrong type", '[grid]\nload = [1e4, "2 kN", 3e4]\n', 'grid.load[1] = "2 kN"', "a number", "1e+08 N")
    t.study("NaN", "[grid]\nfriction = [0.1, 0.2]\nload = [1e4, 2e4, nan]\n", "grid.load[2] = NaN", "1e+08 N")
    t.study("E in GPa", "[grid]\nupper.E = [210e9, 210]\n", "grid.upper.E[1] = 210: ", "GPa")
    t.study("radii in mm", "[grid]\nupper.radii = [[0.46, 0.3], [460, 300]]\n", "grid.upper.radii[1][0] = 460", "100 m")
    t.study("mesh in mm", "[[together]]\nsurface_size = [1e-3, 0.5]\n", "together[0].surface_size[1] = 0.5", "0.5e-3")
    t.study("unknown key", "[grid]\nlaod = [1e4, 2e4]\n", "grid.laod: unknown key; did you mean load?")
    t.study("unknown inner key", "[grid]\nupper.radi = [[1, 1]]\n", "grid.upper.radi: unknown key", "upper.radii")
    t.study("key below a number", "[grid]\nload.x = [1]\n", "grid.load.x: unknown key", "tables and arrays")
    t.study("place beyond an array", '[grid]\n"creepage.7" = [1e-3]\n', "grid.creepage.7: unknown key")
    t.study("key of nothing", '[grid]\n"" = [1e4]\n', 'grid: "": must be a dotted key')
    t.study("key of many dots", '[grid]\n"' + "a." * 30_000 + 'b" = [1]\n', "at most 32 dots")
    t.study("scene name too long", f'kind = "study"\nscene = "{"s" * 100_000}"\n' + loads, "existing scene file")
    t.study("long value twice", f"[grid]\nload = ['{'s' * 9000}', '{'s' * 9000}']\n", "must be listed once")
    t.study("value twice", "[grid]\nload = [1e4, 2e4, 1e4]\n", "grid", "load: 10000.0 must be listed once")
    grid = "".join(
        f"{name} = [{', '.join(str(k * i) for i in range(1, 201))}]\n" for name, k in (("load", 1), ("speed", 0.1))
    )
    t.study("too many cases", "[grid]\n" + grid, "40000 cases (200 load x 200 speed)", "at most 10000")
    values = ", ".join(f"{1e-5 * i:.5f}" for i in range(9999))
    late = f"[grid]\nfriction = [{values}, 3.0]\n"
    t.study("the last of 10 000 values", late, "grid.friction[9999] = 3.0", "0 to 2", scene=CURVE)
    t.study("kind", "[grid]\nkind = ['hertz', 'run']\n", "grid: kind: must not be varied")
    t.study("set in per cent", "[set]\nfriction = 30\n" + loads, "set.friction = 30", "0 to 2")
    t.study("set unknown", "[set]\nfrictoin = 0.3\n" + loads, "set.frictoin: unknown key; did you mean friction?")
    t.study("without what is not there", 'without = ["strips"]\n' + loads, "without: strips", "of the scene")
    t.study(
        "together of unequal lengths", "[[together]]\nload = [1e4, 2e4]\nspeed = [1.0]\n", "load has 2, speed has 1"
    )
    cube = "[latin_hypercube]\nsamples = 8\nranges."
    for samples in ("0", "-1", "1.5", "1_000_000_000", "nan", '"8"'):
        text = cube.replace("8", samples) + "load = {low = 1e4, high = 2e4}\n"
        t.study(f"samples = {samples}", text, "latin_hypercube.samples = ", "a whole number from 1 to 100000")
    between = "latin_hypercube.ranges.load."
    t.study("no ranges", "[latin_hypercube]\nsamples = 8\n", "latin_hypercube.ranges: missing")
    t.study("low above high", cube + "load = {low = 2e4, high = 1e4}\n", f"{between}high = 10000.0", "greater than low")
    t.study("low NaN", cube + "load = {low = nan, high = 1e4}\n", f"{between}low = NaN", "a number")
    t.study("log of zero", cube + 'load = {low = 0, high = 1, scale = "log"}\n', f"{between}low = 0", "greater than 0")
    t.study(
        "log of less", cube + 'load = {low = -1, high = 1, scale = "log"}\n', f"{between}low = -1", "greater than 0"
    )
    t.study("scale of no name", cube + 'load = {low = 1, high = 2, scale = "sq"}\n', f'{between}scale = "sq"', '"log"')
    t.study("range as array", cube + "load = [1, 2]\n", "latin_hypercube.ranges.load = [1, 2]", "low, high")
    t.study("range in GN", cube + "load = {low = 1e9, high = 2e9}\n", "latin_hypercube.ranges.load = 1", "1e+08 N")
    t.study("twice", loads + cube + "load = {low = 1, high = 2}\n", "grid", "load: must be named once")
    errors = loads + "[convergence]\n"
    t.study("convergence of nothing", errors + 'over = "strips"\nreference = "hertz"\n', 'over = "strips"', "load")
    t.study("convergence without reference", errors, "convergence.reference: missing", '"hertz"')
    t.study("reference of no name", errors + 'reference = "exact"\n', 'reference = "exact"', '"hertz"')
    t.study("reference of another key", errors + "reference = {speed = 1}\n", "must have the keys load")
    t.study("reference of a wrong type", errors + 'reference = {load = "x"}\n', 'convergence.reference.load = "x"', "N")
    t.study("reference among the values", errors + "reference = {load = 1e4}\n", "must not be one of the values")
    for workers in ("0", "2000", "1.5", '"2"'):
        text = f"workers = {workers}\n" + loads
        t.study(f"workers = {workers}", text, f"workers = {workers}", "a whole number from 1 to 1024")
    t.study("histories of a contact", "histories = true\n" + loads, "histories = true", 'kind = "run"')
    run = standard(CURVE)
    t.study("histories at every step", "histories = true\n[grid]\nfriction = [0.3]\n", "output.interval", scene=run)
    t.study(
        "speed 1000 times", "[grid]\nvehicle.speed = [45, 45e3]\n", "grid.vehicle.speed[1] = 45000", "m/s", scene=run
    )
    t.study("scene missing", 'kind = "study"\n' + loads, "scene: missing")
    t.study("scene nowhere", 'kind = "study"\nscene = "none.toml"\n' + loads, 'scene = "none.toml"', "existing")
    t.study("scene as folder", 'kind = "study"\nscene = "."\n' + loads, 'scene = "."', "existing scene file")
    t.study("scene as number", 'kind = "study"\nscene = 3\n' + loads, "scene = 3")
    t.study("scene is the study", 'kind = "study"\nscene = "study.toml"\n' + loads, "kind = 'study'", "'hertz'")
    t.study("scene of no TOML", loads, "not valid TOML", scene="hertz\n", where="scene.toml")
    t.study("scene in Latin-1", loads, "UTF-8", where="scene.toml", **{"scene.toml": "# Ü".encode("latin-1")})
    t.study(
        "scene at fault",
        loads,
        "friction = 30",
        scene=HERTZ.replace("friction = 0.3", "friction = 30"),
        where="scene.toml",
    )
    t.study("a scene", HERTZ[HERTZ.index("kind") :], "kind = 'hertz'", '"study"')
    t.study("in Latin-1", "", "line 1", "UTF-8", **{"study.toml": "# Ü".encode("latin-1")})
    for name, content, says in places():
        t.study(name, "", "cannot be read", says, **{"study.toml": content})
    for address in (
        "",
        "nonsense",
        "http://host:8786",
        "tcp://host",
        "tcp://127.0.0.1:99999",
        "tcp://no-such-host.invalid:8786",
    ):
        command = ("study", "study.toml", "--scheduler", address, "--out", "out")
        t.option(
            f"scheduler: {address}",
            command,
            (f"--scheduler {address}:".replace(" :", " :"),),
            **{"study.toml": STUDY + "[grid]\nfriction = [0.3]\n"},
        )
    t.option(
        "out: of a study",
        ("study", "study.toml", "--out", "file"),
        ("--out file", "folder"),
        **{"study.toml": STUDY + "[grid]\nfriction = [0.3]\n", "file": ""},
    )


def views(t: Table) -> None:
    """Options and files of view, animate and example."""
    view, film = ("view", "scene.toml", "--out"), ("animate", "run.nc", "--out")
    pair = {"scene.toml": HERTZ}
    t.option("view: suffix", (*view, "a.jpg"), ("--out a.jpg", ".png, .html"), **pair)
    t.option("view: no folder", (*view, "none/a.png"), ("--out none/a.png", "folder"), **pair)
    t.option("view: nowhere to", ("view", "scene.toml"), ("--out",), **pair)
    for scale in ("0", "-3", "nan", "inf"):
        t.option(
            f"view: scale {scale}", (*view, "a.png", "--scale", scale), (f"--scale {scale}", "greater than 0"), **pair
        )
    t.option("view: scale as word", (*view, "a.png", "--scale", "big"), ("--scale", "number"), **pair)
    t.option(
        "view: body of another kind", (*view, "a.png", "--body", "wheel"), ("--body wheel", "upper, lower"), **pair
    )
    t.option("view: side of a pair", (*view, "a.png", "--side", "left"), ("--side left", "contact"), **pair)
    t.option("view: side", (*view, "a.png", "--side", "up"), ("--side up", "left or right"), **{"scene.toml": WHEELSET})
    t.option("view: standard", (*view, "a.png"), ("standard", '"condensed"'), **{"scene.toml": standard(WHEELSET)})
    t.option("view: a run", (*view, "a.png"), ('kind = "run"', "wheelrail animate"))
    t.option("film: no run", (*film, "a.mp4"), ("run.nc: file does not exist",))
    t.option("film: suffix", (*film, "a.avi"), ("--out a.avi", ".mp4, .gif"))
    t.option("film: no folder", (*film, "none/a.mp4"), ("--out none/a.mp4", "folder"))
    t.option("film: no frames", (*film, "a.mp4", "--frames", "0"), ("--frames", "1"))
    for option, value in (("fps", "nan"), ("fps", "0"), ("scale", "nan"), ("scale", "inf"), ("scale", "-1")):
        t.option(f"film: {option} {value}", (*film, "a.mp4", f"--{option}", value), (f"--{option}",))
    spoiled = {
        "empty": b"",
        "a scene": HERTZ,
        "truncated": b"\x89HDF\r\n\x1a\n half",
        "a picture": PNG,
        "a folder": folder,
    }
    for name, content in spoiled.items():
        t.option(f"film: of {name}", (*film, "a.mp4"), ("run.nc: ",), **{"run.nc": content})
    for name, scene in (("a pair", HERTZ), ("nothing", "x = ["), ("a run without times", CURVE), ("a number", 3)):
        t.option(f"film: of results of {name}", (*film, "a.mp4"), ("run.nc: ",), **{"run.nc": results(scene)})
    t.option("example: of no name", ("example", "herz"), ("NAME = 'herz'", "hertz"))
    t.option("example: a path", ("example", "../pyproject"), ("NAME", "hertz"))


def results(scene: object) -> Callable[[Path], None]:
    """NetCDF file with a scene, as written by a run, without further data."""

    def make(path: Path) -> None:
        from xarray import Dataset

        Dataset({"wheelset_y": ("n", np.zeros(3))}, attrs={"scene": scene}).to_netcdf(path)

    return make


def options(t: Table) -> None:
    picture = ("contact", "scene.toml", "--picture")
    t.option("picture: suffix", (*picture, "patches.jpg"), ("--picture patches.jpg", ".png"))
    t.option("picture: no folder", (*picture, "none/patches.png"), ("--picture none/patches.png", "folder"))
    t.option("picture: is a folder", (*picture, "a.png"), ("--picture a.png", "folder"), **{"a.png": folder})
    track = ("track", "scene.toml", "--picture", "none/track.png")
    t.option("picture: of a track", track, ("--picture none/track.png", "folder"))
    t.option("out: is a file", ("run", "scene.toml", "--out", "file"), ("--out file", "folder"), file="")
    t.option("out: below a file", ("run", "scene.toml", "--out", "file/run"), ("--out file/run", "folder"), file="")
    t.option(
        "out: of a comparison",
        ("compare", "run.toml", "--out", "file"),
        ("--out file",),
        **{"run.toml": CURVE, "file": ""},
    )
    t.option("with: no model", ("compare", "scene.toml", "--with", "hertz"), ("model = ", '"condensed"'))
    t.option("speed: zero", ("modes", "scene.toml", "--speed", "0"), ("--speed", "0.1"))
    t.option("speed: NaN", ("modes", "scene.toml", "--speed", "nan"), ("--speed",))
    t.option("speed: 1000 times", ("curving", "scene.toml", "--speed", "45000"), ("--speed", "200"))
    t.option("speed: a word", ("modes", "scene.toml", "--speed", "fast"), ("--speed", "number"))
    solid = changed(HERTZ, "surface_size = 0.5e-3", 'surface_size = 5e-5\nbodies = "solid"\nhalf_strip = 0.5')
    says = ("scene.toml: surface_size: 20003 x 20003 nodes", "GB of memory or more; this machine has")
    t.option("mesh beyond memory", CONTACT, says, **{"scene.toml": solid})
    wide = changed(HERTZ, "surface_size = 0.5e-3", "surface_size = 5e-5\nhalf_strip = 50.0")
    t.option("lines beyond memory", CONTACT, ("2000003 nodes", "GB of memory or more"), **{"scene.toml": wide})
    fine = changed(WHEELSET, "surface_size = 1e-3", 'surface_size = 5e-5\nbodies = "solid"')
    says = ("scene.toml: surface_size: 801 x 1", "nodes on the surface of the wheel: about ", "GB of memory or more")
    t.option("mesh of a wheel beyond memory", CONTACT, says, **{"scene.toml": fine})
    t.option("contact of a run", ("contact", "run.toml"), ('kind = "run"', "wheelrail run"), **{"run.toml": CURVE})
    t.option("run of a contact", ("run", "pair.toml"), ('kind = "hertz"', "wheelrail contact"), **{"pair.toml": HERTZ})


def every_case() -> list[Case]:
    table = Table()
    for fill in (
        scene_files,
        hertz_scenes,
        wheelset_scenes,
        run_scenes,
        profiles,
        irregularities,
        wagons,
        studies,
        views,
        options,
    ):
        fill(table)
    return table.cases
