#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""An equilibrium of a large body with its sensitivity: ours and FEniCSx side by side in one run.

Sample run, on a machine that does nothing else; needs python3-dolfinx-real and a C compiler
(Debian 12: DOLFINx 0.5.2 with PETSc 3.18), and the benchmarks built:
  tests/benchmark/fenicsx_large.py build/bin/palpate_benchmark_pull_cube

A cube of Tet10, neo-Hookean, held at its bottom, a patch of its top pulled by a tenth of its
height: rest with the sensitivity there, and from its prediction the equilibrium with its force,
sensitivity (three right-hand sides) and stiffness. Both have the same mesh, law, quadrature and
tolerances (EquilibriumOptions::tolerance; 1e-6 of the right-hand sides of the sensitivity), a
process of their own and one core; ours has the lowest eigenvalue besides. Seconds are those of the
processor, of the quickest of the repeats, from the mesh on. Python's and the compiler's work on
FEniCSx's forms is left out, and so is the trial of how many levels GAMG has. Bytes are the peak
beyond the mesh.

FEniCSx is the best script that we know how to write, twice: SNES with a line search and Eisenstat
and Walker's tolerances, conjugate gradients with GAMG and the six motions of a rigid body, as its
pages have it; and the same with a level of the corners between, which is what we do, by PETSc's
means. Forms are compiled with -Ofast for this processor. --variants N solves the body of N bricks
an edge once by each of the variants that were tried, instead.
"""

import argparse
import json
import os
import subprocess
import sys
import time

import numpy as np

try:
    import dolfinx
    import ufl
    from dolfinx import cpp, fem, la
    from dolfinx.fem import petsc as fem_petsc
    from mpi4py import MPI
    from petsc4py import PETSc
except ImportError as error:
    sys.exit(f"FEniCSx is needed: apt install python3-dolfinx-real gcc ({error}).")

EDGE = 0.1  # m
PATCH = 0.2 * EDGE
PULL = np.array((0, 0, EDGE / 10))
YOUNGS_MODULUS = 10e3  # Pa
TOLERANCE = 1e-10
SENSITIVITY_TOLERANCE = 1e-6
BRICKS = (12, 16, 23)
# The six orders of the axes: a tetrahedron of a brick each (Kuhn), as in box_mesh.cpp.
ORDERS = ((0, 1, 2), (1, 2, 0), (2, 0, 1), (1, 0, 2), (0, 2, 1), (2, 1, 0))
JIT = {"cffi_extra_compile_args": ["-Ofast", "-march=native"], "cffi_libraries": ["m"]}

NEWTON = {
    "snes_type": "newtonls", "snes_linesearch_type": "bt", "snes_max_it": 60,
    "snes_ksp_ew": True, "snes_ksp_ew_version": 2, "snes_ksp_ew_rtol0": 0.1,
    "snes_ksp_ew_rtolmax": 0.1, "snes_ksp_ew_gamma": 0.9, "snes_ksp_ew_alpha": 2.0,
    "ksp_type": "cg", "ksp_norm_type": "unpreconditioned", "ksp_max_it": 1000,
    "matptap_via": "rap"}  # a quarter less time than the default
SMOOTHER = {"ksp_type": "chebyshev", "ksp_max_it": 2, "pc_type": "jacobi"}


def gamg(finest=None, smoother=None, **options):
    """Options of GAMG; `finest` are those of the smoother of the finest level.

    Blocks and SOR are for that level alone: an aggregate of a single node leaves rows of zeros.
    """
    return {
        **NEWTON, "pc_type": "gamg", "pc_gamg_threshold": 0.0,
        **{f"mg_levels_{name}": value for name, value in {**SMOOTHER, **(smoother or {})}.items()},
        **{f"finest_{name}": value for name, value in (finest or {}).items()},
        **{name.replace("gamg", "pc_gamg"): value for name, value in options.items()}}


def two_levels(**options):
    """Tet10 and Tet4 on the corners, which GAMG solves for: as we do it, by PETSc."""
    blocks = {**SMOOTHER, "pc_type": "pbjacobi", **options}
    return {
        **NEWTON, "pc_type": "mg", "pc_mg_galerkin": "none", "mg_coarse_ksp_type": "preonly",
        **{f"mg_levels_{name}": value for name, value in blocks.items()},
        "mg_coarse_pc_type": "gamg", "mg_coarse_pc_gamg_threshold": 0.0,
        **{f"mg_coarse_mg_levels_{name}": value for name, value in SMOOTHER.items()}}


BLOCKS = {"pc_type": "pbjacobi"}
KEPT = {"snes_lag_preconditioner": -2}  # made once, for the first step from rest's prediction
VARIANTS = {
    # PETSc's defaults but for the zeros of the held nodes, which must not count as neighbours.
    "GAMG, default": gamg(),
    "the same, P kept": gamg(gamg_reuse_interpolation=True, gamg_recompute_esteig=False),
    "kept": gamg(**KEPT),
    "kept, threshold 0.03": gamg(gamg_threshold=0.03, **KEPT),
    "kept, no aggressive coarsening": gamg(gamg_square_graph=0, **KEPT),
    "kept, plain aggregation": gamg(gamg_agg_nsmooths=0, **KEPT),
    "kept, W-cycle": gamg(pc_mg_cycle_type="w", **KEPT),
    "kept, 3 steps": gamg(smoother={"ksp_max_it": 3}, **KEPT),
    "kept, SOR": gamg(finest={"pc_type": "sor"}, **KEPT),
    "kept, blocks": gamg(finest=BLOCKS, **KEPT),
    "kept, blocks, threshold 0.03": gamg(finest=BLOCKS, gamg_threshold=0.03, **KEPT),
    "blocks, P kept": gamg(finest=BLOCKS, gamg_reuse_interpolation=True),
    "two levels": two_levels(),
    "two levels, kept": {**two_levels(), **KEPT},
    "two levels, 3 steps, kept": {**two_levels(ksp_max_it=3), **KEPT},
    "two levels, SOR, kept": {**two_levels(pc_type="sor"), **KEPT},
    "two levels, W-cycle, kept": {
        **two_levels(), "mg_coarse_pc_mg_cycle_type": "w", **KEPT},
}
# The best at 300 000 unknowns, of GAMG for the whole matrix and of all.
COMPARED = {"FEniCSx, GAMG": "kept, blocks", "FEniCSx, two levels": "two levels, 3 steps, kept"}


def make_mesh(bricks):
    side = np.linspace(0, EDGE, bricks + 1)
    z, y, x = np.meshgrid(side, side, side, indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    stride = np.array((1, bricks + 1, (bricks + 1) ** 2))
    k, j, i = np.meshgrid(*3 * [np.arange(bricks)], indexing="ij")
    first = (i * stride[0] + j * stride[1] + k * stride[2]).ravel()
    cells = np.stack([first[:, None] + np.concatenate(([0], np.cumsum(stride[list(order)])))
                      for order in ORDERS], axis=1).reshape(-1, 4)
    element = ufl.VectorElement("Lagrange", ufl.tetrahedron, 1)
    return dolfinx.mesh.create_mesh(MPI.COMM_SELF, cells.astype(np.int64), points,
                                    ufl.Mesh(element))


def memory(name):
    """VmHWM, the largest so far, or VmRSS, what there is now; bytes."""
    with open("/proc/self/status", encoding="ascii") as status:
        return next(1024 * int(line.split()[1]) for line in status if line.startswith(name))


def forget_peak():
    with open("/proc/self/clear_refs", "w", encoding="ascii") as file:
        file.write("5")


def set_options(options):
    settings = PETSc.Options()
    settings.clear()
    for name, value in options.items():
        settings[name] = value


class Seconds:
    """Of the processor, by what they were spent on."""

    def __init__(self):
        self.of = {}

    def __call__(self, name, function, *arguments):
        start = time.process_time()
        result = function(*arguments)
        self.of[name] = self.of.get(name, 0) + time.process_time() - start
        return result


def rigid_motions(space):
    """The six, orthonormal, with the unknowns of the space."""
    x = space.tabulate_dof_coordinates()
    index_map, size = space.dofmap.index_map, space.dofmap.index_map_bs
    vectors = [la.create_petsc_vector(index_map, size) for _ in range(6)]
    x = x - x.mean(axis=0)
    for axis in range(3):
        b, c = (axis + 1) % 3, (axis + 2) % 3
        vectors[axis].array.reshape(-1, 3)[:, axis] = 1
        turned = vectors[3 + axis].array.reshape(-1, 3)
        turned[:, b], turned[:, c] = -x[:, c], x[:, b]
    la.orthonormalize(vectors)
    return PETSc.NullSpace().create(vectors=vectors, comm=MPI.COMM_SELF)


class Cube:
    """The body, its forms and what SNES works on."""

    def __init__(self, bricks, nu, seconds):
        self.seconds = seconds
        self.mesh = make_mesh(bricks)
        forget_peak()
        self.bytes_before = memory("VmRSS")
        self.space = seconds("set-up", fem.VectorFunctionSpace, self.mesh, ("Lagrange", 2))
        self.make_forms(nu)
        seconds("set-up", self.set_up)
        self.peak = 0
        self.count = 0
        self.coarse = None

    def make_forms(self, nu):
        self.u = fem.Function(self.space)
        self.w = fem.Function(self.space)
        mu = YOUNGS_MODULUS / (2 * (1 + nu))
        lame = YOUNGS_MODULUS * nu / ((1 + nu) * (1 - 2 * nu))
        constants = [fem.Constant(self.mesh, PETSc.ScalarType(value)) for value in (mu, lame)]
        f = ufl.variable(ufl.Identity(3) + ufl.grad(self.u))
        log_j = ufl.ln(ufl.det(f))
        energy = (constants[0] / 2 * (ufl.tr(f.T * f) - 3) - constants[0] * log_j +
                  constants[1] / 2 * log_j ** 2)
        stress = ufl.diff(energy, f)
        dx = ufl.dx(metadata={"quadrature_degree": 2})  # four points
        force = ufl.inner(stress, ufl.grad(ufl.TestFunction(self.space))) * dx
        tangent = ufl.derivative(force, self.u, ufl.TrialFunction(self.space))
        self.force, self.tangent, self.action = (
            fem.form(form, jit_params=JIT)
            for form in (force, tangent, ufl.action(tangent, self.w)))

    def set_up(self):
        space = self.space
        fixed = fem.locate_dofs_geometrical(space, lambda x: np.isclose(x[2], 0))
        self.tool = fem.locate_dofs_geometrical(
            space, lambda x: np.isclose(x[2], EDGE) &
            (np.hypot(x[0] - EDGE / 2, x[1] - EDGE / 2) <= PATCH))
        self.held_at = fem.Function(space)
        self.conditions = [fem.dirichletbc(self.held_at, np.concatenate((fixed, self.tool)))]
        self.held = np.zeros(len(self.held_at.x.array) // 3, bool)
        self.held[fixed] = self.held[self.tool] = True
        self.held_rows = np.repeat(self.held, 3)
        self.k = fem_petsc.create_matrix(self.tangent)
        self.k.setNearNullSpace(rigid_motions(space))
        self.r = fem_petsc.create_vector(self.force)
        self.x = self.k.createVecRight()
        self.r_of_snes = self.r.duplicate()
        self.snes = PETSc.SNES().create(MPI.COMM_SELF)
        self.snes.setFunction(self.residual, self.r_of_snes)
        self.snes.setJacobian(self.jacobian, self.k)
        self.snes.setConvergenceTest(self.has_converged)

    def choose(self, options):
        """Sets the options of PETSc, after a trial of how many levels there are.

        Of all that the two levels of the corners alone are part of the time.
        """
        options = dict(options)
        finest = {name: options.pop(name) for name in list(options) if name.startswith("finest")}
        if finest:
            set_options(options)
            trial = PETSc.PC().create(MPI.COMM_SELF)
            trial.setOperators(self.k)
            trial.setFromOptions()
            trial.setUp()
            level = trial.getMGLevels() - 1
            trial.destroy()
            for name, value in finest.items():
                options[name.replace("finest", f"mg_levels_{level}")] = value
        set_options(options)
        if options["pc_type"] == "mg":
            self.seconds("set-up", self.make_two_levels)
        self.snes.setFromOptions()

    def make_two_levels(self):
        """The corners' tangent PᵀKP and P, of which the rows of what is held are zero."""
        corners = fem.VectorFunctionSpace(self.mesh, ("Lagrange", 1))
        self.p = cpp.fem.petsc.interpolation_matrix(corners._cpp_object, self.space._cpp_object)
        self.p.assemble()
        free = self.r.duplicate()
        free.array = ~self.held_rows
        self.p.diagonalScale(free)
        self.coarse = self.k.PtAP(self.p)
        self.coarse.setBlockSize(3)
        self.coarse.setNearNullSpace(rigid_motions(corners))
        pc = self.snes.getKSP().getPC()
        pc.setType("mg")
        pc.setMGLevels(2)
        pc.setMGInterpolation(1, self.p)
        pc.getMGCoarseSolve().setOperators(self.coarse)

    def assemble(self, form, vector):
        vector.set(0)
        fem_petsc.assemble_vector(vector, form)

    def residual(self, _, x, r):
        self.u.x.array[:] = x.array_r
        self.seconds("residuals", self.assemble, self.force, r)
        r.array.reshape(-1, 3)[self.held] = 0
        r.array += self.held_rows * (x.array_r - self.held_at.x.array)

    def jacobian(self, _, x, *__):
        self.u.x.array[:] = x.array_r
        self.seconds("assembly", self.assemble_tangent)

    def assemble_tangent(self):
        self.k.zeroEntries()
        fem_petsc.assemble_matrix(self.k, self.tangent, self.conditions)
        self.k.assemble()
        if self.coarse is not None:
            self.k.PtAP(self.p, result=self.coarse)

    def take_scale(self):
        """The norms of the rows of the tangent at rest, for the tolerance; not part of the time."""
        self.peak = max(self.peak, memory("VmHWM"))
        start, _, values = self.k.getValuesCSR()
        self.inverse_norm = 1 / np.sqrt(np.add.reduceat(values ** 2, start[:-1]))
        del start, _, values
        forget_peak()

    def has_converged(self, snes, iteration, *_):
        largest = np.abs(snes.getFunction()[0].array_r * self.inverse_norm).max() / PULL.max()
        if not np.isfinite(largest):
            return PETSc.SNES.ConvergedReason.DIVERGED_FNORM_NAN
        if largest <= TOLERANCE:
            return PETSc.SNES.ConvergedReason.CONVERGED_FNORM_ABS
        if iteration >= self.snes.max_it:
            return PETSc.SNES.ConvergedReason.DIVERGED_MAX_IT
        return PETSc.SNES.ConvergedReason.ITERATING

    def start(self):
        """The tangent at rest."""
        self.x.set(0)
        self.jacobian(None, self.x)

    def linearise(self):
        """v and k at the state u, of which the tangent is in self.k."""
        self.snes.setUseEW(False)  # which would set the tolerance of these solves, too
        ksp = self.snes.getKSP()
        ksp.setOperators(self.k)
        ksp.setTolerances(rtol=SENSITIVITY_TOLERANCE, atol=0)
        v = np.zeros((3, len(self.w.x.array)))
        right, solution = self.r.duplicate(), self.r.duplicate()
        for c in range(3):
            unit = self.w.x.array.reshape(-1, 3)
            unit[:] = 0
            unit[self.tool, c] = 1
            v[c] = unit.ravel()
            self.assemble(self.action, right)
            right.scale(-1)
            right.array.reshape(-1, 3)[self.held] = 0
            self.seconds("solves", ksp.solve, right, solution)
            if ksp.getConvergedReason() < 0:
                sys.exit(f"The sensitivity was not found: {ksp.getConvergedReason()}.")
            self.count += ksp.getIterationNumber()
            v[c] += np.where(self.held_rows, 0, solution.array_r)
        stiffness = np.zeros((3, 3))
        for c in range(3):  # vᵀKv, of which the error is the square of that of v
            self.w.x.array[:] = v[c]
            self.assemble(self.action, right)
            stiffness[:, c] = v @ right.array_r
        return v, (stiffness + stiffness.T) / 2

    def reaction(self):
        self.assemble(self.force, self.r)
        return self.r.array_r.reshape(-1, 3)[self.tool].sum(axis=0)

    def pull(self, v):
        self.held_at.x.array.reshape(-1, 3)[self.tool] = PULL
        self.x.array[:] = PULL @ v
        self.snes.setUseEW(True)
        self.snes.solve(None, self.x)
        if self.snes.getConvergedReason() < 0:
            sys.exit(f"SNES ended with {self.snes.getConvergedReason()}.")
        self.count += self.snes.getLinearSolveIterations()
        self.jacobian(None, self.x)
        force = self.reaction()
        return force, self.linearise()[1]


def solve(bricks, nu, variant):
    """One solve with one variant, in this process: its figures."""
    Cube(2, nu, Seconds())  # the forms are compiled, or found
    seconds = Seconds()
    cube = Cube(bricks, nu, seconds)
    seconds("rest", cube.start)
    cube.take_scale()
    cube.choose(VARIANTS[variant])
    forget_peak()
    v, _ = seconds("rest", cube.linearise)
    cube.count = 0
    force, stiffness = seconds("configuration", cube.pull, v)
    points = 2 * bricks + 1
    return {
        "unknowns": 3 * points * points * (points - 1), "set_up": seconds.of["set-up"],
        "rest": seconds.of["rest"], "configuration": seconds.of["configuration"],
        "newton": cube.snes.getIterationNumber(), "iterations": cube.count,
        "bytes": max(cube.peak, memory("VmHWM")) - cube.bytes_before,
        "force": list(force), "stiffness": list(stiffness.ravel())}


def start(command):
    """The figures that a process prints as its last line, and nothing of one that fails."""
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode != 0:
        reason = (done.stderr.strip() or "no message").splitlines()[-1]
        return None, f"{' '.join(map(str, command))} ended with {done.returncode}: {reason}"
    return json.loads(done.stdout.splitlines()[-1]), None


def alone(bricks, nu, variant):
    return [sys.executable, __file__, "--alone", variant, "--bricks", str(bricks), "--nu", str(nu)]


def total(figures):
    return figures["set_up"] + figures["rest"] + figures["configuration"]


def print_row(cells):
    print("| " + " | ".join(cells) + " |", flush=True)


def print_header(names):
    print_row(names)
    print("|" + len(names) * "---|", flush=True)


def cells_of(figures):
    return [f"{figures['set_up']:.2f}", f"{figures['rest']:.2f}",
            f"{figures['configuration']:.2f}", f"{total(figures):.2f}", f"{figures['newton']}",
            f"{figures['iterations']}", f"{figures['bytes'] / 1e6:.0f}"]


COLUMNS = ["set-up, s", "rest, s", "configuration, s", "all, s", "Newton", "iterations", "MB"]


def compare_variants(bricks, nu):
    print_header(["variant", *COLUMNS])
    for variant in VARIANTS:
        figures, failure = start(alone(bricks, nu, variant))
        print_row([variant, *(cells_of(figures) if figures else [failure])])


def difference(ours, theirs, name):
    a, b = np.array(ours[name]), np.array(theirs[name])
    return np.linalg.norm(a - b) / np.linalg.norm(a)


def exponent(sizes, values):
    return np.polyfit(np.log(sizes), np.log(values), 1)[0]


def compare(program, bricks_of_all, nu, repeats):
    print_header(["unknowns", "", *COLUMNS, "configuration / ours", "all / ours",
                  "difference of the force", "of the stiffness"])
    best = {}  # by name, for each size
    for bricks in bricks_of_all:
        commands = {"ours": [program, str(bricks), str(nu)],
                    **{name: alone(bricks, nu, variant) for name, variant in COMPARED.items()}}
        runs = {name: [] for name in commands}
        for _ in range(repeats):
            for name, command in commands.items():
                figures, failure = start(command)
                if failure:
                    sys.exit(failure)
                runs[name].append(figures)
        ours = min(runs["ours"], key=total)
        for name, each in runs.items():
            row = min(each, key=total)
            best.setdefault(name, []).append(row)
            ratios = ["", "", "", ""] if row is ours else [
                f"{row['configuration'] / ours['configuration']:.1f}",
                f"{total(row) / total(ours):.1f}",
                *(f"{difference(ours, row, figure):.0e}" for figure in ("force", "stiffness"))]
            print_row([str(ours["unknowns"]), name, *cells_of(row), *ratios])
    if len(bricks_of_all) < 2:
        return
    for name, rows in best.items():
        sizes = [row["unknowns"] for row in rows]
        print_row(["**exponent**", name, "", "",
                   f"{exponent(sizes, [row['configuration'] for row in rows]):.2f}",
                   f"{exponent(sizes, [total(row) for row in rows]):.2f}", "", "",
                   f"{exponent(sizes, [row['bytes'] for row in rows]):.2f}", "", "", "", ""])


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("program", nargs="?", help="palpate_benchmark_pull_cube")
    parser.add_argument("--bricks", type=int, nargs="+", default=BRICKS, help="along an edge")
    parser.add_argument("--nu", type=float, default=0.45)
    parser.add_argument("--repeats", type=int, default=2)
    parser.add_argument("--variants", type=int, metavar="BRICKS",
                        help="compare the variants of FEniCSx")
    parser.add_argument("--alone", choices=VARIANTS, metavar="VARIANT",
                        help="solve by this variant once, as JSON")
    arguments = parser.parse_args()
    if arguments.alone:
        print(json.dumps(solve(arguments.bricks[0], arguments.nu, arguments.alone)))
    elif arguments.variants:
        compare_variants(arguments.variants, arguments.nu)
    elif arguments.program:
        compare(arguments.program, arguments.bricks, arguments.nu, arguments.repeats)
    else:
        parser.error("the program palpate_benchmark_pull_cube is needed, or --variants")


if __name__ == "__main__":
    main()
