#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Which folder may look where.

    check_includes.py <root of the sources>

Prints one line a violation, `file:line: what`, and ends with 1 if there is any. The rules are the
tables below: the parts of solvers/ and the rooms of filters/ see only those before them, VTK stays
in filters/ and plugin/, and each outside library in the one place that wraps it. What a folder may
not see it may not see through a header either. Besides, every folder at the top is known and no
file holds a path of somebody's machine.
"""

import functools
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
    ("CZMQ", r"c?zmq\.h"),
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
     r"(sys|arpa|netinet)/\w+\.h"
     r"|(unistd|dirent|fcntl|spawn|signal|poll|dlfcn|pthread|sched|ucontext)\.h"),
    ("std", r"[a-z_0-9]+"),
]


class Unit(NamedTuple):
    """What the sources of a folder may include, besides those of the folder itself."""

    libraries: set
    folders: set = frozenset()


# The parts of solvers/ in order: each may include those before it.
SOLVER_PARTS = ["base", "threads", "mesh", "materials", "reduced", "elements", "assembly",
                "cutting", "interaction", "soft_contact", "linear", "iterative", "equilibrium",
                "tearing", "discretisation", "dynamics", "state_space", "fields", "interpolation",
                "storage", "schedule", "exploration", "following", "reduction", "accuracy",
                "explorers"]


def solver_units():
    wrapped = {
        "base": {"POSIX", "xxHash"},  # where a program of ours is; the hash of what counts
        "threads": {"OpenMP", "POSIX"},
        "assembly": {"xxHash"},  # the hash of a scene
        "linear": {"MUMPS", "METIS", "MPI", "POSIX"},
        "fields": {"zlib"},
        "storage": {"SQLite", "xxHash", "POSIX"},
        "schedule": {"MPI"},
        "reduction": {"xxHash"},  # what a model follows from
        "explorers": {"CZMQ", "POSIX"},  # connections, and processes of this machine
    }
    # What a servo loop computes with needs no more than this.
    narrower = {"reduced": {"solvers/base", "solvers/materials"}}
    return {
        f"solvers/{part}": Unit({"std", "Eigen"} | wrapped.get(part, set()),
                                narrower.get(part, {f"solvers/{earlier}"
                                                    for earlier in SOLVER_PARTS[:index]}))
        for index, part in enumerate(SOLVER_PARTS)
    }


def haptic_units():
    """The parts of haptic/ in order, as those of solvers/, with the programs."""
    solvers = {"solvers/base", "solvers/mesh", "solvers/materials", "solvers/reduced",
               "solvers/state_space", "solvers/fields", "solvers/interpolation"}
    # The program reads a file; what runs beside it only has what was read.
    further = {
        "palpate_servo": {"solvers/storage"},
        # What is explored while it is touched.
        "exploring": {f"solvers/{part}" for part in SOLVER_PARTS},
    }
    wrapped = {"transport": {"hidapi"}, "recording": {"CSV"}, "palpate_servo": {"CLI11"}}
    parts = ["realtime", "profile", "guardian", "palpate_guardian", "transport", "touching",
             "exploring", "simulating", "servo", "recording", "palpate_servo"]
    return {
        f"haptic/{part}": Unit({"std", "POSIX", "Eigen"} | wrapped.get(part, set()),
                               {f"haptic/{earlier}" for earlier in parts[:index]} | solvers
                               | further.get(part, set()))
        for index, part in enumerate(parts)
    }


# The rooms of filters/ in order, each with the last part of solvers/ that it may include. Which of
# the rooms before it a room includes is said by its vtk.module, from which the build has the
# folders that a compiler looks in.
FILTER_ROOMS = {
    "common": "exploration",  # the progress of a run
    "surface": "mesh",
    "segmentation": "base",
    "meshing": "mesh",
    "scene": "exploration",  # a scene goes from rank to rank as configurations do
    "cutting": "exploration",
    "febio": "assembly",
    "tool": "dynamics",
    "solving": "exploration",
    "state_space": "accuracy",
    "reduction": "reduction",
    "touching": "following",
}


def filter_units():
    rooms = list(FILTER_ROOMS)
    wrapped = {"segmentation": {"filters/programs/program"}}  # what palpate-image answers with
    return {
        f"filters/{room}": Unit({"std", "POSIX", "VTK"},
                                {f"filters/{earlier}" for earlier in rooms[:index]}
                                | {f"solvers/{part}" for part
                                   in SOLVER_PARTS[:SOLVER_PARTS.index(FILTER_ROOMS[room]) + 1]}
                                | wrapped.get(room, set()))
        for index, room in enumerate(rooms)
    }


# The folders of plugin/PalpateInteractor in order, each with what it may include besides those
# before it.
INTERACTOR_FOLDERS = {
    "common": {"filters"},
    "mouse": {"filters", "haptic"},
    "view": {"filters", "haptic"},
    "touch": {"filters", "haptic"},
    "widgets": {"filters"},
    "dock": {"filters", "haptic"},
}


def interactor_units():
    place = "plugin/PalpateInteractor"
    wrapped = {"common": {"X11"}}  # the keys that are pressed while no window hears them
    folders = list(INTERACTOR_FOLDERS)
    return {
        f"{place}/{folder}": Unit({"std", "VTK", "ParaView", "Qt"} | wrapped.get(folder, set()),
                                  {f"{place}/{earlier}" for earlier in folders[:index]}
                                  | INTERACTOR_FOLDERS[folder])
        for index, folder in enumerate(folders)
    }


# The longest folder that matches counts.
UNITS = solver_units() | haptic_units() | filter_units() | interactor_units() | {
    "solvers/palpate_explore": Unit({"std", "POSIX", "CLI11"},
                                    {"solvers/base", "solvers/explorers"}),
    "solvers/palpate_follow": Unit({"std", "CLI11"},
                                   {f"solvers/{part}" for part in SOLVER_PARTS}),
    # What the programs that a filter starts share.
    "filters/programs/program": Unit({"std", "POSIX"}),
    "filters/programs/tetgen": Unit({"std", "POSIX", "VTK", "TetGen"},
                                    {"filters/programs/program"}),
    "filters/programs/image": Unit({"std", "POSIX", "ITK", "zlib"}, {"filters/programs/program"}),
    "plugin/Palpate": Unit({"std", "VTK", "ParaView"}, {"filters"}),
    # What somebody else's program would be.
    "examples": Unit({"std", "Eigen"}, {"haptic", "solvers/base", "solvers/state_space",
                                        "solvers/interpolation", "solvers/storage"}),
    "tests": Unit({name for name, _ in LIBRARIES}, {"solvers", "haptic", "filters", "plugin"}),
}

# What a folder sees through headers of others although it may not include it: (folder, what it
# sees, why). None is to be added: the way out is a header that needs less.
THROUGH_HEADERS = [
    ("haptic", "solvers/assembly", "a StateSpace has the Scene that it is of"),
    ("haptic", "solvers/interaction", "a ToolSpace has the tool as it is stored"),
    ("plugin", "solvers", "filters and servo take and give the solvers' values"),
    ("examples", "solvers/assembly", "as haptic"),
    ("examples", "solvers/interaction", "as haptic"),
    ("examples", "solvers/fields", "a touch space is made of the fields of a file"),
    ("examples", "solvers/materials", "those of the Scene"),
    ("examples", "solvers/mesh", "that of the Scene, and the trees of a Touchable"),
]

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


def folder_of(root, path):
    return path.parent.relative_to(root).as_posix()


@functools.lru_cache(maxsize=None)
def folders_of_bare_names(root):
    """Where the headers are that VTK's and Qt's habit includes by their names alone."""
    return [*(root / "filters" / room for room in FILTER_ROOMS),
            *(root / "plugin/PalpateInteractor" / folder for folder in INTERACTOR_FOLDERS)]


def header_of(root, source, name):
    """The path of a header of ours; None when `name` is none of ours."""
    for start in (root / "solvers", root, root / "tests", root / "filters/programs", source.parent,
                  *folders_of_bare_names(root)):
        if (start / name).is_file():
            return start / name
    return None


@functools.lru_cache(maxsize=None)
def headers_of(root, source):
    """The headers of ours that a file includes, as (line, header)."""
    return [(number, header) for number, name in includes_of(source)
            for header in [header_of(root, source, name)] if header]


def check_reach(root, source, exceptions, used):
    """What a file sees through headers although it may not, as (line, what)."""
    unit = unit_of(folder_of(root, source))
    if unit is None:
        return
    seen = set()
    told = set()
    for number, included in headers_of(root, source):
        waiting = [included]
        while waiting:
            header = waiting.pop()
            for _, further in headers_of(root, header):
                target = folder_of(root, further)
                if further in seen:
                    continue
                seen.add(further)
                waiting.append(further)
                if is_inside(target, unit, *UNITS[unit].folders):
                    continue
                excepted = [(place, what) for place, what, _ in exceptions
                            if is_inside(unit, place) and is_inside(target, what)]
                used.update(excepted)
                if not excepted and target not in told:
                    told.add(target)
                    yield number, (f"{header.name}: through it {unit} sees {target}, which it may "
                                   "not include")


@functools.lru_cache(maxsize=None)
def rooms_in(module_file):
    """The rooms of filters/ that a vtk.module names, by the names of their modules."""
    words = module_file.read_text(encoding="utf-8").split()
    return {word for word in words if word.startswith("Palpate::")}


def module_of(room):
    special = {"febio": "FEBio"}
    return "Palpate::" + special.get(room, room.title().replace("_", ""))


def check_modules(root):
    """Rooms without a vtk.module, and those whose file names one that comes after them."""
    rooms = list(FILTER_ROOMS)
    for index, room in enumerate(rooms):
        if not (root / "filters" / room).is_dir():
            continue
        module_file = root / "filters" / room / "vtk.module"
        if not module_file.is_file():
            yield f"filters/{room}: no vtk.module"
            continue
        for later in rooms[index + 1:]:
            if module_of(later) in rooms_in(module_file):
                yield (f"filters/{room}/vtk.module: it names {module_of(later)}, which comes after "
                       "it")


def check_include(root, source, name):
    """What is wrong with an #include; None when nothing is."""
    folder = source.parent.relative_to(root).as_posix()
    unit = unit_of(folder)
    if unit is None:
        return f"{folder} has no rule: give it one in check_includes.py"
    if ".." in Path(name).parts:
        return f"{name}: the name starts at a root, without .."
    header = header_of(root, source, name)
    if header is not None:
        target = folder_of(root, header)
        if is_inside(target, "solvers") and "/" not in name:
            return f"{name}: the name starts with the part of solvers/"
        if not is_inside(target, unit, *UNITS[unit].folders):
            return f"{name}: {unit} may not include {target}"
        module_file = root / unit / "vtk.module"
        room = target.removeprefix("filters/")
        if (module_file.is_file() and target != unit and room in FILTER_ROOMS
                and module_of(room) not in rooms_in(module_file)):
            return f"{name}: {unit}/vtk.module does not name {module_of(room)}"
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


def includes_of(path):
    """The names that a file includes, as (line, name)."""
    if path.suffix in SOURCE_SUFFIXES:
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
            include = INCLUDE.match(line)
            if include:
                yield number, include.group(1)


def check_file(root, path, exceptions, used):
    """The violations of one file, as (line, what)."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except UnicodeDecodeError:
        return  # a picture
    for number, line in enumerate(lines, start=1):
        if MACHINE_PATH.search(line):
            yield number, "a path of somebody's machine"
    for number, name in includes_of(path):
        what = check_include(root, path, name)
        if what:
            yield number, what
    if path.suffix in SOURCE_SUFFIXES:
        yield from check_reach(root, path, exceptions, used)


def check_tree(root, exceptions=()):
    """All violations, a line of text each. `exceptions` are as THROUGH_HEADERS."""
    used = set()
    for entry in sorted(root.iterdir()):
        if entry.is_dir() and entry.name not in TOP_FOLDERS and not IGNORED.fullmatch(entry.name):
            yield f"{entry.name}: an unknown folder at the top"
    yield from check_modules(root)
    for path in files_of(root):
        for number, what in check_file(root, path, exceptions, used):
            yield f"{path.relative_to(root)}:{number}: {what}"
    for place, what, _ in exceptions:
        if (place, what) not in used:
            yield f"{place} no longer sees {what} through a header: delete the exception"


def main():
    violations = list(check_tree(Path(sys.argv[1]).resolve(), THROUGH_HEADERS))
    print("\n".join(violations) or "No violation.")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())
