#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Which folder may look where.

    check_includes.py <root of the sources>

Prints one line a violation, `file:line: what`, and ends with 1 if there is any. The rules are the
tables below: the parts of solvers/ see only those before them, VTK stays in filters/ and plugin/,
and each outside library in the one place that wraps it. Besides, every folder at the top is known
and no file holds a path of somebody's machine.
"""

import re
import sys
from pathlib import Path
from typing import NamedTuple

# The folders at the top. Those of IGNORED are not part of the sources.
TOP_FOLDERS = {".ci", ".github", "cmake", "examples", "filters", "haptic", "plugin", "solvers",
               "tests", "xml"}
IGNORED = re.compile(r"build.*|out|\.git|__pycache__")

# Outside libraries by the form of the name in an #include; the first that matches counts.
LIBRARIES = [
    ("MUMPS", r"[sdcz]?mumps_\w+\.h"),
    ("METIS", r"metis\.h"),
    ("MPI", r"mpi\.h"),
    ("OpenMP", r"omp\.h"),
    ("SQLite", r"sqlite3\w*\.h"),
    ("xxHash", r"xxh\w+\.h"),
    ("zlib", r"zlib\.h"),
    ("TetGen", r"tetgen\.h"),
    ("ITK", r"itk\w+\.h|NrrdIO\.h"),
    ("hidapi", r"(hidapi/)?hidapi\w*\.h"),
    ("CSV", r"csv\.h"),
    ("CLI11", r"CLI/.+"),
    ("Linux", r"linux/\w+\.h"),
    ("Eigen", r"(unsupported/)?Eigen/.+"),
    ("GoogleTest", r"g(test|mock)/.+"),
    ("Google Benchmark", r"benchmark/.+"),
    ("JSON", r"nlohmann/json(_fwd)?\.hpp"),
    # VTK's own that look like vtkSM…, and the one filter of ParaView's VTK extensions: it knows the
    # queries of Find Data, which VTK's selections do not.
    ("VTK", r"vtkSMP(Tools|ThreadLocal\w*)\.h|vtkPVExtractSelection\.h"),
    ("ParaView", r"(vtkSM|vtkPV|vtkSI|vtkClientServer|pq)\w+\.h"),
    ("VTK", r"(vtk|QVTK)\w+\.(h|txx)|vtksys/.+"),
    ("Qt", r"(Qt\w+/)?Q[A-Z]\w*"),
    ("X11", r"X11/\w+\.h"),
    ("POSIX",
     r"sys/\w+\.h|(unistd|dirent|fcntl|spawn|signal|poll|dlfcn|pthread|sched|ucontext)\.h"),
    ("std", r"[a-z_0-9]+"),
]


class Unit(NamedTuple):
    """What the sources of a folder may include, besides those of the folder itself."""

    libraries: set
    folders: set = frozenset()


def solver_units():
    """The parts of solvers/ in order: each may include those before it."""
    wrapped = {
        "base": {"POSIX", "xxHash"},  # where a program of ours is; the hash of what counts
        "threads": {"OpenMP", "POSIX"},
        "assembly": {"xxHash"},  # the hash of a scene
        "linear": {"MUMPS", "METIS", "MPI", "POSIX"},
        "state_space": {"SQLite", "xxHash", "zlib", "POSIX"},
        "schedule": {"MPI"},
        "reduction": {"xxHash"},  # what a model follows from
    }
    parts = ["base", "threads", "mesh", "materials", "reduced", "elements", "assembly",
             "interaction", "linear", "iterative", "equilibrium", "dynamics",
             "state_space", "interpolation", "schedule", "exploration", "reduction", "accuracy"]
    # What a servo loop computes with needs no more than this.
    narrower = {"reduced": {"solvers/base", "solvers/materials"}}
    return {
        f"solvers/{part}": Unit({"std", "Eigen"} | wrapped.get(part, set()),
                                narrower.get(part, {f"solvers/{earlier}"
                                                    for earlier in parts[:index]}))
        for index, part in enumerate(parts)
    }


def haptic_units():
    """The parts of haptic/ in order, as those of solvers/, with the programs."""
    solvers = {"solvers/base", "solvers/mesh", "solvers/materials", "solvers/reduced",
               "solvers/state_space", "solvers/interpolation"}
    wrapped = {"transport": {"hidapi"}, "recording": {"CSV"}, "palpate_servo": {"CLI11"}}
    parts = ["realtime", "profile", "guardian", "palpate_guardian", "transport", "touching",
             "simulating", "servo", "recording", "palpate_servo"]
    return {
        f"haptic/{part}": Unit({"std", "POSIX", "Eigen"} | wrapped.get(part, set()),
                               {f"haptic/{earlier}" for earlier in parts[:index]} | solvers)
        for index, part in enumerate(parts)
    }


# The longest folder that matches counts.
UNITS = solver_units() | haptic_units() | {
    "filters": Unit({"std", "POSIX", "VTK"}, {"solvers"}),
    # What the programs that a filter starts share.
    "filters/program": Unit({"std", "POSIX"}),
    "filters/tetgen": Unit({"std", "POSIX", "VTK", "TetGen"}, {"filters/program"}),
    "filters/image": Unit({"std", "POSIX", "ITK", "zlib"}, {"filters/program"}),
    "plugin/Palpate": Unit({"std", "VTK", "ParaView"}, {"filters"}),
    "plugin/PalpateInteractor": Unit({"std", "VTK", "ParaView", "Qt", "X11"},
                                     {"filters", "haptic"}),
    # What somebody else's program would be.
    "examples": Unit({"std", "Eigen"}, {"haptic", "solvers/base", "solvers/state_space",
                                        "solvers/interpolation"}),
    "tests": Unit({name for name, _ in LIBRARIES}, {"solvers", "haptic", "filters", "plugin"}),
}

SOURCE_SUFFIXES = {".h", ".cpp", ".cxx", ".txx"}
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]')
GENERATED = re.compile(r"Palpate\w+Module\.h")
MACHINE_PATH = re.compile(r"(?<![\w.}])/(home|root|work)/")


def is_inside(folder, *others):
    return any(folder == other or folder.startswith(other + "/") for other in others)


def unit_of(folder):
    return max((unit for unit in UNITS if is_inside(folder, unit)), key=len, default=None)


def library_of(name):
    return next((library for library, form in LIBRARIES if re.fullmatch(form, name)), None)


def folder_of_header(root, source, name):
    """The folder of a header of ours, relative to the root; None when `name` is none of ours."""
    for start in (root / "solvers", root, root / "tests", root / "filters", source.parent):
        if (start / name).is_file():
            return (start / name).parent.relative_to(root).as_posix()
    return None


def check_include(root, source, name):
    """What is wrong with an #include; None when nothing is."""
    folder = source.parent.relative_to(root).as_posix()
    unit = unit_of(folder)
    if unit is None:
        return f"{folder} has no rule: give it one in check_includes.py"
    if ".." in Path(name).parts:
        return f"{name}: the name starts at a root, without .."
    target = folder_of_header(root, source, name)
    if target is not None:
        if is_inside(target, "solvers") and "/" not in name:
            return f"{name}: the name starts with the part of solvers/"
        if not is_inside(target, unit, *UNITS[unit].folders):
            return f"{name}: {unit} may not include {target}"
        return None
    if is_inside(unit, "filters", "plugin", "tests") and GENERATED.fullmatch(name):
        return None
    library = library_of(name)
    if library is None:
        return f"{name}: neither a header of the project nor of a library with a rule"
    if library not in UNITS[unit].libraries:
        return f"{name}: {unit} may not include {library}"
    return None


def files_of(root):
    for entry in sorted(root.iterdir()):
        if IGNORED.fullmatch(entry.name):
            continue
        if entry.is_dir():
            yield from files_of(entry)
        else:
            yield entry


def check_file(root, path):
    """The violations of one file, as (line, what)."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except UnicodeDecodeError:
        return  # a picture
    for number, line in enumerate(lines, start=1):
        if MACHINE_PATH.search(line):
            yield number, "a path of somebody's machine"
        include = INCLUDE.match(line) if path.suffix in SOURCE_SUFFIXES else None
        if include:
            what = check_include(root, path, include.group(1))
            if what:
                yield number, what


def check_tree(root):
    """All violations, a line of text each."""
    for entry in sorted(root.iterdir()):
        if entry.is_dir() and entry.name not in TOP_FOLDERS and not IGNORED.fullmatch(entry.name):
            yield f"{entry.name}: an unknown folder at the top"
    for path in files_of(root):
        for number, what in check_file(root, path):
            yield f"{path.relative_to(root)}:{number}: {what}"


def main():
    violations = list(check_tree(Path(sys.argv[1]).resolve()))
    print("\n".join(violations) or "No violation.")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())
