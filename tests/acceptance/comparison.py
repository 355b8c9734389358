"""The evaluation that proves the claim: all methods on one input, measured alike, against what voroform claims.

Run alone, it makes and checks one comparison: comparison.py --build FOLDER --resolution N INPUT
"""

from __future__ import annotations

import argparse
import json
import math
import tempfile
from pathlib import Path

from report import Program, Report, main_report

SCANS = ("kitten.xyz", "ball.ply", "hippo1.ply")
SMOOTH_SHAPES = ("torus", "ellipsoid", "bumpy-sphere", "sphere")
SHARP_SHAPES = ("box", "gyroid-ball")
RESOLUTIONS = (50, 100)
# Sites that methods are compared at; the resolution of Marching Cubes that gives about as many is looked for.
SITES = 14474
# Largest Dmean relative to Marching Cubes at equal resolution.
SHAPE_BOUNDS = {"cvt2": 0.48, "cvt3": 0.30, "cvt2+fit": 0.24, "cvt4": 0.17}
SCAN_BOUNDS = {"cvt2": 0.62, "cvt3": 0.45}
# Of cvt2, relative to Delaunay refinement.
DELAUNAY_BOUND = 0.6
# At equal numbers of boundary triangles, of the better of cvt2+fit and cvt4, and of cvt4 itself; Dmean and Drmse alike.
EQUAL_TRIANGLES_BOUNDS = {"mc": (0.45, 0.60), "delaunay": (0.55, 0.75)}
# Volumes of shapes that have a formula; cvt4's error is smaller than cvt3's by this factor.
EXACT_VOLUMES = {"shape:torus": 2 * math.pi**2 * 0.4**2, "shape:ellipsoid": 4 / 3 * math.pi * 0.35,
                 "shape:sphere": 4 / 3 * math.pi}
VOLUME_GAIN = 10
# On scans cvt4 relative to cvt3.
SCAN_FIT_BOUND = 0.85
# Mean and largest regularity of the kitten's cells from random sites after ten iterations, and what the fit changes.
KITTEN_MEAN_REGULARITY = 0.0814
KITTEN_LARGEST_REGULARITY = 0.10
FIT_CHANGES_REGULARITY = 0.005
TIME_LIMIT = 900
# Seconds of a whole comparison without Delaunay refinement, and of its evaluation per 15,000 cells.
COMPARE_SECONDS = 60
EVALUATION_SECONDS = 20
EVALUATION_CELLS = 15000

METHODS = ("mc", "delaunay", "cvt1@0", "cvt1", "cvt2", "cvt3", "cvt4")
FITTED_METHODS = ("mc", "delaunay", "cvt1", "cvt1+fit", "cvt2", "cvt2+fit", "cvt3", "cvt4")


def compare(report: Report, program: Program, name: object, resolution: int, *more: object) -> dict | None:
    """comparison.json of one run, or None if there is none."""
    with tempfile.TemporaryDirectory() as folder:
        outcome = program.run("compare", name, "-o", folder, "--resolution", resolution, *more)
        report.equal("exit code", outcome.returncode, 0)
        path = Path(folder) / "comparison.json"
        if not path.exists():
            print(outcome.stderr)
            return None
        print((Path(folder) / "comparison.md").read_text(encoding="utf-8"))
        return json.loads(path.read_text(encoding="utf-8"))


def check_certificates(report: Report, comparison: dict, expected: tuple[str, ...] = METHODS) -> None:
    report.equal("methods", tuple(comparison["methods"]), expected)
    for name, method in comparison["methods"].items():
        if method["failure"]:
            report.information(f"{name} failed", method["failure"])
            report.check(f"{name} has a result", False, "= True", name == "delaunay")
            continue
        valid = method["validity"]["valid"]
        if name == "delaunay":  # CGAL's guarantee, not ours
            report.information("delaunay is valid", valid)
        else:
            report.equal(f"{name} is valid", valid, True)
        report.equal(f"{name} samples without a nearest point", unfound(method), 0)
    equal = comparison["equal_triangles"] or {}
    for name, group in equal.items():
        for baseline in ("mc", "delaunay"):
            if baseline in group and not group[baseline]["failure"]:
                ours = comparison["methods"][name]["accuracy"]["dmean"]
                theirs = group[baseline]["accuracy"]["dmean"]
                report.information(f"{name} Dmean / {baseline} at equal triangles", f"{ours / theirs:.4f}")


def unfound(method: dict) -> int:
    return sum(direction["unfound"] for direction in method["accuracy"]["per_direction"].values())


def check_ratios(report: Report, comparison: dict, bounds: dict[str, float]) -> None:
    methods = comparison["methods"]
    for name, bound in bounds.items():
        report.at_most(f"{name} Dmean / mc", methods[name]["relative_to"]["mc"]["dmean"], bound)
    if not methods["delaunay"]["failure"]:
        report.at_most("cvt2 Dmean / delaunay", methods["cvt2"]["relative_to"]["delaunay"]["dmean"], DELAUNAY_BOUND)


def check_regularity(report: Report, comparison: dict) -> None:
    for name, method in comparison["methods"].items():
        if method["failure"]:
            continue
        statistics = method["regularity"]["all"]
        report.information(f"{name} mean and largest G", f"{statistics['mean']:.5f}, {statistics['max']:.4f}")


def check_dual(report: Report, comparison: dict) -> None:
    """The dual of cvt1 against Delaunay refinement in each mean; the second criterion is better when smaller."""
    methods = comparison["methods"]
    if methods["delaunay"]["failure"]:
        return
    dual = methods["cvt1"]["quality"]["dual"]
    pairs = (("vq", dual["tetrahedra"], methods["delaunay"]["quality"]["tetrahedra"]),
             ("sq", dual["boundary_triangles"], methods["delaunay"]["quality"]["boundary_triangles"]))
    for prefix, ours, theirs in pairs:
        for number in (1, 2, 3, 4):
            key = f"{prefix}{number}"
            a, b = ours["mean"][key], theirs["mean"][key]
            better = a < b if number == 2 else a > b
            report.check(f"{key.upper()} of the dual of cvt1", a, f"better than delaunay's {b:.6g}", better)


def resolution_for(report: Report, program: Program, name: object, sites: int) -> int:
    """The resolution whose number of inside cubes comes nearest to `sites`."""
    counts: dict[int, int] = {}

    def count(resolution: int) -> int:
        if resolution not in counts:
            with tempfile.TemporaryDirectory() as folder:
                program.run("compare", name, "-o", folder, "--resolution", resolution, "--methods", "mc",
                            "--no-equal-triangles", show=False)
                record = json.loads((Path(folder) / "comparison.json").read_text(encoding="utf-8"))
                counts[resolution] = record["sites"]
        return counts[resolution]

    # Sites grow as the cube of the resolution.
    best = 50
    while True:
        wanted = round(best * (sites / count(best)) ** (1 / 3))
        if wanted in counts:
            break
        best = wanted
    best = min(counts, key=lambda resolution: abs(counts[resolution] - sites))
    report.information(f"resolution of {name} for about {sites} sites", f"{best}: {count(best)} sites")
    return best


def check_fit(report: Report, comparison: dict, name: object, scan: bool) -> None:
    """Fitted caps against unfitted ones, and at equal numbers of boundary triangles."""
    methods = comparison["methods"]
    fitted, plain = methods["cvt4"], methods["cvt3"]
    change = abs(fitted["regularity"]["all"]["mean"] / plain["regularity"]["all"]["mean"] - 1)
    report.at_most("change of the mean G by the fit", change, FIT_CHANGES_REGULARITY)
    ratio = fitted["accuracy"]["dmean"] / plain["accuracy"]["dmean"]
    if scan:
        report.at_most("cvt4 Dmean / cvt3", ratio, SCAN_FIT_BOUND)
        report.at_most("cvt4 Dmax / cvt3", fitted["accuracy"]["dmax"] / plain["accuracy"]["dmax"], 1.0)
        return
    if name in EXACT_VOLUMES:
        exact = EXACT_VOLUMES[name]
        errors = [abs(method["validity"]["volume"] - exact) for method in (plain, fitted)]
        report.check("volume error of cvt3 / cvt4", errors[0] / errors[1], f">= {VOLUME_GAIN}",
                     errors[0] >= VOLUME_GAIN * errors[1])
    report.at_most("cvt4 Nmean / cvt3", fitted["accuracy"]["nmean"] / plain["accuracy"]["nmean"], 1.0)
    for baseline, (best_bound, own_bound) in EQUAL_TRIANGLES_BOUNDS.items():
        for criterion in ("dmean", "drmse"):
            ratios = {}
            for name in ("cvt2+fit", "cvt4"):
                opponent = comparison["equal_triangles"][name][baseline]
                if opponent["failure"]:
                    report.information(f"{baseline} with the triangles of {name}", opponent["failure"])
                else:
                    ratios[name] = methods[name]["accuracy"][criterion] / opponent["accuracy"][criterion]
            if ratios:
                best = min(ratios, key=ratios.get)
                report.at_most(f"{criterion} / {baseline} at equal triangles, {best}", ratios[best], best_bound)
            if "cvt4" in ratios:
                report.at_most(f"{criterion} / {baseline} at equal triangles, cvt4", ratios["cvt4"], own_bound)


def check_at_sites(report: Report, program: Program, name: object, bounds: dict[str, float] | None) -> None:
    """A comparison at about SITES sites; without bounds the ratios are printed only."""
    scan = isinstance(name, Path)
    report.start(f"comparison: {Path(str(name)).name} at about {SITES} sites")
    resolution = resolution_for(report, program, name, SITES)
    methods = ("--methods", ",".join(FITTED_METHODS), "--delaunay-time-limit", TIME_LIMIT)
    comparison = compare(report, program, name, resolution, *methods)
    if comparison is None:
        return
    check_certificates(report, comparison, FITTED_METHODS)
    check_regularity(report, comparison)
    if bounds is None:
        for method in ("cvt2", "cvt3", "cvt4"):
            report.information(f"{method} Dmean / mc",
                               f"{comparison['methods'][method]['relative_to']['mc']['dmean']:.4f}")
        return
    check_ratios(report, comparison, bounds)
    check_fit(report, comparison, name, scan)


def check_inputs(report: Report, program: Program, data: Path) -> None:
    limit = ("--delaunay-time-limit", TIME_LIMIT, "--no-equal-triangles")
    for name in (*(data / scan for scan in SCANS), "shape:torus"):
        for resolution in RESOLUTIONS:
            stem = Path(str(name)).name
            report.start(f"comparison: {stem} at resolution {resolution}")
            comparison = compare(report, program, name, resolution, *limit)
            if comparison is None:
                continue
            check_certificates(report, comparison)
            check_regularity(report, comparison)
            if stem != "hippo1.ply":
                check_dual(report, comparison)
            if stem == "kitten.xyz":
                statistics = comparison["methods"]["cvt1"]["regularity"]["all"]
                report.at_most("kitten: mean G", statistics["mean"], KITTEN_MEAN_REGULARITY)
                report.at_most("kitten: largest G", statistics["max"], KITTEN_LARGEST_REGULARITY)


def check_time(report: Report, program: Program, data: Path) -> None:
    methods = tuple(method for method in METHODS if method != "delaunay")
    for name in ("shape:torus", data / "kitten.xyz"):
        report.start(f"comparison: time, {Path(str(name)).name} at resolution 100")
        comparison = compare(report, program, name, 100, "--methods", ",".join(methods))
        if comparison is None:
            continue
        check_certificates(report, comparison, methods)
        seconds = comparison["seconds"]
        report.at_most("seconds in all", seconds["total"], COMPARE_SECONDS)
        report.information("sites, seconds of evaluation", f"{comparison['sites']}, {seconds['evaluation']:.2f}")
    report.start(f"comparison: time of the evaluation at about {EVALUATION_CELLS} sites")
    resolution = resolution_for(report, program, "shape:torus", EVALUATION_CELLS)
    comparison = compare(report, program, "shape:torus", resolution, "--methods", ",".join(methods))
    if comparison is not None:
        report.at_most("seconds of evaluation", comparison["seconds"]["evaluation"], EVALUATION_SECONDS)


def check(report: Report, program: Program, data: Path) -> None:
    check_time(report, program, data)
    check_inputs(report, program, data)
    for shape in SMOOTH_SHAPES:
        check_at_sites(report, program, f"shape:{shape}", SHAPE_BOUNDS)
    for scan in ("kitten.xyz", "ball.ply"):
        check_at_sites(report, program, data / scan, SCAN_BOUNDS)
    for shape in SHARP_SHAPES:
        check_at_sites(report, program, f"shape:{shape}", None)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=Path, required=True)
    parser.add_argument("--resolution", type=int, required=True)
    parser.add_argument("input")
    options = parser.parse_args()

    def one_run(report: Report) -> None:
        report.start(f"{options.input} at resolution {options.resolution}")
        comparison = compare(report, Program(options.build, report), options.input, options.resolution)
        if comparison is not None:
            check_certificates(report, comparison)
            check_regularity(report, comparison)
            check_dual(report, comparison)

    main_report(one_run)
