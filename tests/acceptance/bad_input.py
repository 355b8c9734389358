"""Point 7: bad input gives the right exit code, a message that names the place, and no output file."""

from __future__ import annotations

import math
import struct
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path

from report import Program, Report

ENVIRONMENT, USAGE, INPUT = 1, 2, 3

Point = tuple[float, float, float]


def sphere(count: int) -> list[tuple[Point, Point]]:
    """Points of the unit sphere on a spiral, with their normals."""
    result = []
    for i in range(count):
        z = 1 - (2 * i + 1) / count
        angle = i * math.pi * (3 - math.sqrt(5))
        radius = math.sqrt(1 - z * z)
        point = (radius * math.cos(angle), radius * math.sin(angle), z)
        result.append((point, point))
    return result


def xyz(points: list[tuple[Point, Point]]) -> bytes:
    return "".join(" ".join(map(repr, (*p, *n))) + "\n" for p, n in points).encode()


def ply(points: list[tuple[Point, Point]], declared: int | None = None) -> bytes:
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {declared or len(points)}\n"
    header += "".join(f"property double {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz")) + "end_header\n"
    return header.encode() + b"".join(struct.pack("<6d", *p, *n) for p, n in points)


# Name, content, and a part of the message that names the place in the file.
BAD_FILES: list[tuple[str, str, bytes, str]] = [
    ("empty file", "empty.ply", b"", "empty.ply"),
    ("truncated binary PLY", "cut.ply", ply(sphere(200))[:-60], "198"),
    ("a header that declares 4·10⁹ points", "vast.ply", ply(sphere(10), 4_000_000_000), "4000000000"),
    ("text where numbers belong", "text.xyz", xyz(sphere(60)) + b"0.1 0.2 left 0 0 1\n", "61"),
    ("only NaN points", "nan.xyz", b"nan nan nan 0 0 1\n" * 100, "100"),
    ("10 points", "ten.xyz", xyz(sphere(10)), "10"),
    ("coplanar points", "flat.xyz", xyz([((x, y, 0.5), (0, 0, 1)) for (x, y, _), _ in sphere(200)]), "plane"),
]


def files_below(folder: Path) -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if not path.is_dir())


class Case:
    """One run that must fail, in a folder of its own."""

    def __init__(self, report: Report, program: Program) -> None:
        self.report = report
        self.program = program

    def fails(self, name: str, code: int, place: str, arguments: Callable[[Path], list], files: dict[str, bytes]) -> None:
        self.report.start(f"7 bad input: {name}")
        with tempfile.TemporaryDirectory() as temporary:
            folder = Path(temporary)
            for file, content in files.items():
                (folder / file).write_bytes(content)
            outcome = self.program.run(*arguments(folder))
            self.check(outcome, code, place, files_below(folder), sorted(files))

    def check(self, outcome: subprocess.CompletedProcess, code: int, place: str, found: list, expected: list) -> None:
        self.report.equal("exit code", outcome.returncode, code)
        self.report.information("message", outcome.stderr.strip())
        self.report.check("the message names the place", place in outcome.stderr, f"holds '{place}'", place in outcome.stderr)
        self.report.equal("files left", found, expected)


def check_full_disk(report: Report, program: Program) -> None:
    """A real file system of 1 MiB, in a mount namespace of its own, so that nothing stays mounted."""
    report.start("7 bad input: a 1 MiB tmpfs that fills up")
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        binary = program.build.resolve() / "pipeline" / "voroform"
        script = (
            'mount -t tmpfs -o size=1m none "$1" && { "$2" tessellate shape:torus -o "$1/out" --sites 5000; code=$?; '
            'find "$1" -type f; exit $code; }'
        )
        words = ["unshare", "--user", "--map-root-user", "--mount", "sh", "-c", script, "sh", str(folder), str(binary)]
        report.command(words)
        outcome = subprocess.run(words, capture_output=True, text=True, check=False)
        case = Case(report, program)
        case.check(outcome, ENVIRONMENT, "No space left on device", outcome.stdout.split(), [])


def check(report: Report, program: Program, data: Path) -> None:
    case = Case(report, program)
    good = xyz(sphere(500))

    def reconstruct(file: str, *more: object) -> Callable[[Path], list]:
        return lambda folder: ["reconstruct", folder / file, "-o", folder / "out", "--sites", 100, *more]

    case.fails("negative control: nothing is wrong", 0, "", lambda folder: ["info", folder / "good.xyz"], {"good.xyz": good})
    case.fails("missing file", INPUT, "none.xyz", reconstruct("none.xyz"), {})
    for name, file, content, place in BAD_FILES:
        case.fails(name, INPUT, place, reconstruct(file), {file: content})
    case.fails(
        "zero sites", USAGE, "--sites",
        lambda folder: ["reconstruct", folder / "good.xyz", "-o", folder / "out", "--sites", 0], {"good.xyz": good},
    )
    case.fails(
        "more sites than memory allows", ENVIRONMENT, "memory",
        lambda folder: ["reconstruct", folder / "good.xyz", "-o", folder / "out", "--sites", 2_000_000_000],
        {"good.xyz": good},
    )
    case.fails(
        "an output path below a regular file", ENVIRONMENT, "good.xyz",
        lambda folder: ["reconstruct", folder / "good.xyz", "-o", folder / "good.xyz" / "out"], {"good.xyz": good},
    )
    check_full_disk(report, program)
    case.fails("unknown option", USAGE, "--sitess", reconstruct("good.xyz", "--sitess", 5), {"good.xyz": good})
    case.fails(
        "unknown TOML key", USAGE, "sitess",
        lambda folder: ["reconstruct", folder / "good.xyz", "-o", folder / "out", "--config", folder / "run.toml"],
        {"good.xyz": good, "run.toml": b"sitess = 100\n"},
    )
