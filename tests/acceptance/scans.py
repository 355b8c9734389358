"""Point 2: real scans give valid tessellations, whatever the caps and the number of sites; what is lost is warned about.

Run alone, it makes and checks one tessellation: scans.py --build FOLDER --sites N --method M SCAN
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

from report import Program, Report, main_report, metrics_of
from surface import check_surface

SCANS = ("kitten.xyz", "oni.pwn", "ball.ply", "sphere_20k_normal.xyz", "hippo1.ply")
METHODS = ("cvt1", "cvt2", "cvt3")
SITES = (2000, 15000, 60000)

# The volume error of fidelity is bounded for this many sites and more.
FIDELITY_SITES = 15000
FIDELITY_BOUND = 0.01

# Two ways to sum the same volume: rounding only.
VOLUME_AGREEMENT = 1e-9


def check_result(report: Report, folder: Path, sites: int) -> dict | None:
    """Checks certificate and surface of a result folder; returns its metrics."""
    metrics = metrics_of(folder)
    report.check("metrics.json", "written" if metrics else "missing", "written", metrics is not None)
    if metrics is None:
        return None
    validity = metrics["validity"]
    report.equal("validity.valid", validity["valid"], True)
    report.equal("validity.self_intersections", validity["self_intersections"], 0)
    report.equal("validity.point_violations", validity["point_violations"], 0)
    report.equal("counts.sites", metrics["counts"]["sites"], sites)
    report.information("counts.cells", metrics["counts"]["cells"])
    if sites >= FIDELITY_SITES:
        report.at_most("|fidelity.volume_error|", abs(metrics["fidelity"]["volume_error"]), FIDELITY_BOUND)
    else:
        report.information("fidelity.volume_error", metrics["fidelity"]["volume_error"])

    surface = check_surface(folder / "surface.ply")
    report.equal("open edges of surface.ply", surface.open_edges, 0)
    report.equal("unused vertices of surface.ply", surface.unused_vertices, 0)
    report.equal("components of surface.ply", surface.components, validity["components"])
    report.equal("Euler number of surface.ply", surface.euler, validity["euler_characteristic"])
    difference = abs(surface.volume - validity["volume"]) / abs(validity["volume"])
    report.at_most("relative difference of the volume of surface.ply", difference, VOLUME_AGREEMENT)
    return metrics


def reconstruct(report: Report, program: Program, scan: Path, method: str, sites: int, *more: object) -> dict | None:
    with tempfile.TemporaryDirectory() as folder:
        outcome = program.run("reconstruct", scan, "-o", folder, "--method", method, "--sites", sites, *more)
        report.equal("exit code", outcome.returncode, 0)
        if outcome.returncode != 0:
            print(outcome.stderr)
        return check_result(report, Path(folder), sites)


def write_sheet(path: Path, length: float, thickness: float, spacing: float) -> None:
    """An oriented cloud of a square sheet: both sides and the rim."""
    lines = []
    count = round(length / spacing)
    for i in range(count + 1):
        for j in range(count + 1):
            x, y = (i / count - 0.5) * length, (j / count - 0.5) * length
            for side in (-1, 1):
                lines.append(f"{x} {y} {side * thickness / 2} 0 0 {side}")
    for i in range(count + 1):
        along = (i / count - 0.5) * length
        for side in (-1, 1):
            lines.append(f"{side * length / 2} {along} 0 {side} 0 0")
            lines.append(f"{along} {side * length / 2} 0 0 {side} 0")
    path.write_text("\n".join(lines) + "\n", encoding="ascii")


def check_thin_parts(report: Report, program: Program) -> None:
    """What thinner parts than a cell lose is counted and warned about."""
    report.start("2 scans: thin parts, shape:gyroid-ball")
    with tempfile.TemporaryDirectory() as folder:
        outcome = program.run("tessellate", "shape:gyroid-ball", "-o", folder, "--sites", 2000)
        report.equal("exit code", outcome.returncode, 0)
        metrics = check_result(report, Path(folder), 2000)
        if metrics is not None:
            check_loss_is_told(report, metrics, outcome.stderr)

    report.start("2 scans: thin parts, a sheet of half the cell size")
    # n cells of size h in a sheet of area 1 and thickness h/2: n·h³ = h/2, so h = (2n)^(-1/2).
    sites = 500
    cell_size = (2 * sites) ** -0.5
    with tempfile.TemporaryDirectory() as folder:
        sheet = Path(folder) / "sheet.xyz"
        write_sheet(sheet, 1.0, cell_size / 2, cell_size / 4)
        result = Path(folder) / "result"
        outcome = program.run("reconstruct", sheet, "-o", result, "--sites", sites)
        report.equal("exit code", outcome.returncode, 0)
        metrics = check_result(report, result, sites)
        if metrics is not None:
            check_loss_is_told(report, metrics, outcome.stderr)


def check_loss_is_told(report: Report, metrics: dict, messages: str) -> None:
    fidelity = metrics["fidelity"]
    for figure in ("volume_error", "missed_share", "multi_loop_cells", "disconnected_cells", "empty_sites"):
        report.information(f"fidelity.{figure}", fidelity[figure])
    lost = abs(fidelity["volume_error"]) > 0.02
    warned = any("volume" in warning for warning in metrics["warnings"])
    report.check("warning about lost volume", warned, f"= {lost} (volume error above 2 %)", warned == lost)
    if lost:
        report.check("the warning on the terminal", "volume" in messages, "= True", "volume" in messages)


def check(report: Report, program: Program, data: Path) -> None:
    for scan in SCANS:
        for method in METHODS:
            for sites in SITES:
                report.start(f"2 scans: {scan}, {method}, {sites} sites")
                reconstruct(report, program, data / scan, method, sites)
    check_thin_parts(report, program)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=Path, required=True)
    parser.add_argument("--sites", type=int, required=True)
    parser.add_argument("--method", choices=METHODS, required=True)
    parser.add_argument("scan", type=Path)
    options = parser.parse_args()
    if not options.scan.exists():
        raise SystemExit(f"{options.scan} is missing: datasets-scripts/fetch-scans gets it")

    def one_run(report: Report) -> None:
        report.start(f"{options.scan.name}, {options.method}, {options.sites} sites")
        reconstruct(report, Program(options.build, report), options.scan, options.method, options.sites)

    main_report(one_run)
