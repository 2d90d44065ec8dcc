# SPDX-License-Identifier: BSD-3-Clause
"""Parts that touch, here and in GetFEM 5.4 (Debian: python3-getfem), on the same meshes.

Sample run, on one core:
  PV_PLUGIN_PATH=$(echo build/lib/paraview-*/plugins/Palpate) OPENBLAS_NUM_THREADS=1 \\
    pvpython tests/benchmark/getfem_contact.py

Both codes get the same arrays of ten-node tetrahedra and the same neo-Hookean energy, so that the
error of the mesh is the same; the first line printed is how well they agree on one body that
touches nothing. Ours has the soft layer of SoftContact. GetFEM's surfaces are hard: its raytracing
transformation finds the gap at points of the lower body's surface, and a multiplier that is linear
in each face, by the augmented Lagrangian of Alart and Curnier, lets nothing through.

The first table is of round bodies without friction. The lower one is fixed at its bottom, and a
bonded tool brings the upper one nearer by the approach, which counts from where the surfaces meet.
The layer is in edges of the mesh there, as is the radius a of the contact. The force is ours, ours
without what PartLayerForce says of it, and GetFEM's. The stiffness is HapticStiffness, and in
GetFEM the derivative of the force where that is the same: of a smooth curve through the forces at
steps of 0.25 mm, because a hard contact becomes stiffer in jumps of some 2 %, whenever it reaches
the next nodes. Seconds are from rest, in GetFEM in these steps.

The second is of two blocks that are pressed flat on each other, with meshes that do not match and a
Poisson's ratio of 0, so that the stress across is uniform: how far the mean stresses of cells are
from that of all, rms and the largest, in the middle of the blocks and everywhere.
"""

import argparse
import itertools
import time
from dataclasses import dataclass

import getfem as gf
import numpy as np
from numpy.polynomial import Polynomial
from paraview import servermanager
from paraview.simple import AssignMaterial, PVTrivialProducer, SetBoundary, SolveEquilibrium
from scipy.optimize import brentq
from scipy.spatial import cKDTree
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import VTK_QUADRATIC_TETRA, vtkUnstructuredGrid

# Corners of the edges, in the order of VTK's midside nodes.
EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
# VTK's nodes in the order of GetFEM.
NODES_OF_GETFEM = (0, 4, 1, 6, 5, 2, 7, 8, 9, 3)
MIRRORED = (0, 2, 1, 3, 6, 5, 4, 7, 9, 8)
# Points that are nearer to each other are one, m.
SAME = 1e-9

YOUNG, POISSON = 5e3, 0.4  # Pa, no unit
STIFFER = 4.0
# R of the pair of round bodies, the radius of contact that the mesh is for, and its edges in that.
PAIR_RADIUS, CONTACT_RADIUS, EDGES_IN_RADIUS = 0.05, 0.01, 4
EDGE = CONTACT_RADIUS / EDGES_IN_RADIUS
COARSE_LAYERS, GROWTH = 2, 2.5  # of edges beyond those of the contact
SECTORS = 8
STEP, NUM_STEPS = 0.00025, 9  # of GetFEM's approach, m
COMPARED = (4, 6)  # steps to the approaches of the table
DEGREE = 3  # of the curve through GetFEM's forces
HERTZ = 1.5  # the power of the approach with which the force grows

SIDE, HEIGHT = 0.04, 0.02  # of a block, m
LOWER_DIVISIONS, UPPER_DIVISIONS = (5, 5, 2), (4, 4, 2)
BLOCK_EDGE, BLOCK_STEPS = SIDE / UPPER_DIVISIONS[0], 8
MIDDLE = 0.6  # share of the width that is the middle

# One body that touches nothing: the way of a tip, m, that holds what is nearer to its apex.
TIP_WAY, TIP_RADIUS = (0.001, 0.0005, -0.002), CONTACT_RADIUS

RELEASE = 2 * EDGE  # GetFEM finds what is nearer than this, m
# Where surfaces begin to touch within a face, a rule of few points makes the stiffness jump.
CONTACT_RULE = "IM_STRUCTURED_COMPOSITE(IM_TETRAHEDRON(5),2)"
TOUCHING = 1  # the number of a region
MOST_ITERATIONS, TOLERANCE = 40, 1e-8
# Of Newton's method; a line search would stop where the surfaces first meet.
WHOLE_STEPS = ("lsearch", "simplest", "alpha min", 0.99, "alpha max ratio", 1e3)
ENERGY = ("0.5*mu{0}*(Norm_sqr(Id(3)+Grad_u{0})-3)-mu{0}*log(Det(Id(3)+Grad_u{0}))"
          "+0.5*la{0}*sqr(log(Det(Id(3)+Grad_u{0})))")


@dataclass
class Body:
    """Points (m) and cells in VTK's order; which of the points are fixed, which the tool holds, and
    which may touch the other body."""
    points: np.ndarray
    cells: np.ndarray
    young: float
    fixed: np.ndarray
    tool: np.ndarray
    touching: np.ndarray


@dataclass
class Pressed:
    """An equilibrium: the force that holds the tool (N), the stress across, the mean of each cell
    (Pa), what of the force is told as the layer's (N), and its derivative along z (N/m)."""
    force: np.ndarray
    stress: np.ndarray
    seconds: float
    unknowns: int = 0
    of_layer: np.ndarray | None = None
    stiffness: float | None = None


# Meshes -------------------------------------------------------------------------------------------


def growing(even):
    """Places of planes: `even` edges of the contact, then longer ones."""
    edges = [EDGE] * even + [EDGE * GROWTH ** (i + 1) for i in range(COARSE_LAYERS)]
    return np.concatenate(([0], np.cumsum(edges)))


def tetrahedra(shape, point_of):
    """Corners of six tetrahedra in each cube of a lattice; what has no volume is left out."""
    cells = []
    for cube in itertools.product(*map(range, shape)):
        for path in itertools.permutations(range(3)):
            steps = np.cumsum([np.zeros(3, int), *np.eye(3, dtype=int)[list(path)]], axis=0)
            corners = [point_of(*(cube + step)) for step in steps]
            if len(set(corners)) == len(corners):
                cells.append(corners)
    return np.array(cells)


def with_midside_nodes(points, cells):
    """The same of ten nodes, each cell with a positive volume."""
    a, b, c, d = points[cells].transpose(1, 0, 2)
    is_left = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) < 0
    cells = np.where(is_left[:, None], cells[:, (0, 2, 1, 3)], cells)
    edges = np.sort(cells[:, EDGES].reshape(-1, 2), axis=1)
    unique, index = np.unique(edges, axis=0, return_inverse=True)
    return (np.concatenate((points, points[unique].mean(axis=1))),
            np.hstack((cells, len(points) + index.reshape(-1, len(EDGES)))))


def make_cap(curvature, young, turn=0.0):
    """A cylinder under a paraboloid, which its cells have exactly and whose apex is the origin. Its
    flat base is fixed."""
    radii, depths = growing(EDGES_IN_RADIUS + 2), growing(EDGES_IN_RADIUS - 1)
    rings = len(radii) - 1
    angles = turn + 2 * np.pi * np.arange(SECTORS) / SECTORS
    axis = [(0, 0, -depth) for depth in depths]
    around = [(r * np.cos(angle), r * np.sin(angle), -depth)
              for depth in depths for r in radii[1:] for angle in angles]

    def point_of(ring, sector, layer):
        if ring == 0:
            return layer
        return len(depths) + (layer * rings + ring - 1) * SECTORS + sector % SECTORS

    points, cells = with_midside_nodes(
        np.array(axis + around), tetrahedra((rings, SECTORS, len(depths) - 1), point_of))
    is_top = points[:, 2] > -SAME
    is_base = points[:, 2] < SAME - depths[-1]
    from_axis = np.hypot(points[:, 0], points[:, 1])
    points[:, 2] -= (1 + points[:, 2] / depths[-1]) * curvature / 2 * from_axis**2
    return Body(points, cells, young, is_base, np.zeros_like(is_base),
                is_top & (from_axis < 2 * CONTACT_RADIUS + SAME))


def make_block(divisions, young):
    """A block under the origin, which is the middle of its top. Its base is fixed."""
    counts = np.array(divisions) + 1
    lattice = np.array(list(itertools.product(*map(range, counts))))
    points = (lattice / divisions - (0.5, 0.5, 1)) * (SIDE, SIDE, HEIGHT)
    points, cells = with_midside_nodes(
        points, tetrahedra(divisions, lambda *at: int(np.ravel_multi_index(at, counts))))
    is_base = points[:, 2] < SAME - HEIGHT
    return Body(points, cells, young, is_base, np.zeros_like(is_base), points[:, 2] > -SAME)


def above(body, gap):
    """The body upside down over the origin, with its base held by the tool."""
    return Body(body.points * (1, 1, -1) + (0, 0, gap), body.cells[:, MIRRORED], body.young,
                body.tool, body.fixed, body.touching)


# Ours ---------------------------------------------------------------------------------------------


def grid_of(bodies):
    """All bodies as one grid, with the arrays that make it a scene with parts."""
    starts = np.cumsum([0] + [len(body.points) for body in bodies])
    points = vtkPoints()
    points.SetData(numpy_to_vtk(np.concatenate([body.points for body in bodies]), deep=True))
    grid = vtkUnstructuredGrid()
    grid.SetPoints(points)
    for start, body in zip(starts, bodies):
        for cell in start + body.cells:
            grid.InsertNextCell(VTK_QUADRATIC_TETRA, len(cell), cell.tolist())
    part = np.concatenate([np.full(len(body.cells), i) for i, body in enumerate(bodies)])
    fixed = np.concatenate([body.fixed for body in bodies]).astype(np.int8)
    for attributes, name, values in ((grid.GetCellData(), "Part", part),
                                     (grid.GetPointData(), "Fixed", fixed)):
        array = numpy_to_vtk(values, deep=True)
        array.SetName(name)
        attributes.AddArray(array)
    return grid


class Ours:
    """Bodies under Solve Equilibrium. The tool holds its points as one, by the one in their middle,
    or each by itself."""

    def __init__(self, bodies, poissons_ratio, layer=None, as_one=True):
        producer = PVTrivialProducer()
        producer.GetClientSideObject().SetOutput(grid_of(bodies))
        scene = AssignMaterial(
            Input=producer, RegionType="Table", RegionArray="Part",
            Regions=[text for i, body in enumerate(bodies) for text in (
                str(i), "Neo-Hookean",
                f"YoungsModulus {body.young:g} PoissonsRatio {poissons_ratio:g}")])
        if layer is not None:
            scene = SetBoundary(Input=scene, Support="Nothing", Contact="Between Parts",
                                ContactThickness=layer)
        points = np.concatenate([body.points for body in bodies])
        nodes = np.flatnonzero(np.concatenate([body.tool for body in bodies]))
        radius = 0.0
        if as_one:
            middle = cKDTree(points[nodes]).query(points[nodes].mean(axis=0))[1]
            radius = np.linalg.norm(points[nodes] - points[nodes[middle]], axis=1).max() + SAME
            nodes = nodes[[middle]]
        self.solve = SolveEquilibrium(Input=scene, ActiveNodes=nodes.tolist(), TipRadius=radius,
                                      Stress=1)
        self.num_nodes = len(nodes)

    def press(self, displacement):
        """The equilibrium at a displacement of the tool, from rest."""
        start = time.perf_counter()
        self.solve.Displacement = list(displacement) * self.num_nodes
        self.solve.UpdatePipeline()
        data = servermanager.Fetch(self.solve)
        seconds = time.perf_counter() - start
        fields = data.GetFieldData()

        def total(name):
            array = fields.GetArray(name)
            return vtk_to_numpy(array).reshape(-1, 3).sum(axis=0) if array else np.zeros(3)

        assert fields.GetArray("Outcome").GetValue(0) == 0, fields.GetAbstractArray(
            "Message").GetValue(0)
        size = 3 * self.num_nodes
        stiffness = vtk_to_numpy(fields.GetArray("HapticStiffness")).reshape(size, size)
        return Pressed(total("ReactionForce"),
                       vtk_to_numpy(data.GetCellData().GetArray("CauchyStress"))[:, 2], seconds,
                       int(fields.GetArray("Unknowns").GetValue(0)), total("PartLayerForce"),
                       stiffness[2::3, 2::3].sum())


# GetFEM -------------------------------------------------------------------------------------------


class OfGetFEM:
    """The same bodies in GetFEM, each with a mesh and a displacement of its own, u0 and u1. What is
    held is held by multipliers, h0 and h1, which are minus the force."""

    def __init__(self, bodies, poissons_ratio):
        self.bodies = bodies
        self.model = gf.Model("real")
        self.fields = []
        self.bricks = []
        self.held = [np.flatnonzero(body.fixed | body.tool) for body in bodies]
        self.is_tool = [body.tool[held] for body, held in zip(bodies, self.held)]
        for index, body in enumerate(bodies):
            mesh = gf.Mesh("empty", 3)
            for cell in body.cells[:, NODES_OF_GETFEM]:
                mesh.add_convex(gf.GeoTrans("GT_PK(3,2)"), body.points[cell].T)
            field = gf.MeshFem(mesh, 3)
            field.set_fem(gf.Fem("FEM_PK(3,2)"))
            self.fields.append((mesh, field, gf.MeshIm(mesh, gf.Integ("IM_TETRAHEDRON(2)"))))
            self._add_body(index, poissons_ratio)

    def _add_body(self, index, poissons_ratio):
        body, (_, field, rule) = self.bodies[index], self.fields[index]
        self.model.add_fem_variable(f"u{index}", field)
        shear = body.young / (2 * (1 + poissons_ratio))
        self.model.add_initialized_data(f"mu{index}", shear)
        self.model.add_initialized_data(f"la{index}",
                                        2 * shear * poissons_ratio / (1 - 2 * poissons_ratio))
        self.model.add_nonlinear_term(rule, ENERGY.format(index))
        places = cKDTree(field.basic_dof_nodes()[:, ::3].T)
        held = self.held[index]
        pick = gf.Spmat("empty", 3 * len(held), field.nbdof())
        for row, node in enumerate(places.query(body.points[held])[1]):
            for axis in range(3):
                pick.add(3 * row + axis, 3 * int(node) + axis, 1.0)
        self.model.add_variable(f"h{index}", 3 * len(held))
        self.bricks.append(self.model.add_constraint_with_multipliers(
            f"u{index}", f"h{index}", pick, np.zeros(3 * len(held))))

    def _set_region(self, index):
        """Faces of the outside whose points may touch."""
        mesh, touching = self.fields[index][0], self.bodies[index].touching
        _, point = cKDTree(self.bodies[index].points).query(mesh.pts().T)
        faces = mesh.faces_from_pid(np.flatnonzero(touching[point]))
        outer = set(map(tuple, mesh.outer_faces().T))
        mesh.set_region(TOUCHING, faces[:, [tuple(face) in outer for face in faces.T]])

    def touch(self):
        """Body 0, the softer one, is the slave, which has the multiplier; 1 is the master."""
        model = self.model
        self._set_region(0)
        self._set_region(1)
        mesh = self.fields[0][0]
        pressure = gf.MeshFem(mesh, 1)
        pressure.set_fem(gf.Fem("FEM_PK(3,1)"))
        model.add_filtered_fem_variable("p", pressure, TOUCHING)
        # The augmentation, Pa/m: ten times as much, or a tenth, changes a force by up to 1 %.
        model.add_initialized_data("r", self.bodies[0].young / EDGE)
        model.add_raytracing_transformation("ray", RELEASE)
        model.add_slave_contact_boundary_to_raytracing_transformation("ray", mesh, "u0", TOUCHING)
        model.add_master_contact_boundary_to_raytracing_transformation(
            "ray", self.fields[1][0], "u1", TOUCHING)
        rule = gf.MeshIm(mesh, gf.Integ(CONTACT_RULE))
        normal = "Transformed_unit_vector(Grad_u0,Normal)"
        gap = f"((Interpolate(X,ray)+Interpolate(u1,ray)-X-u0).{normal})"
        for term in (f"-p*(Test_u0.{normal})",
                     f"Interpolate_filter(ray,p*(Interpolate(Test_u1,ray).{normal}),1)",
                     "Interpolate_filter(ray,-p*Test_p,0)",
                     f"Interpolate_filter(ray,-(p+neg_part(p+r*{gap}))*Test_p,1)"):
            model.add_nonlinear_term(rule, term, TOUCHING)
        self.kept = (pressure, rule)  # the model only refers to them

    def press(self, displacement):
        """The equilibrium at a displacement of the tool, from the last one."""
        start = time.perf_counter()
        for brick, is_tool in zip(self.bricks, self.is_tool):
            self.model.set_private_rhs(brick, np.outer(is_tool, displacement).ravel())
        _, converged = self.model.solve("max_iter", MOST_ITERATIONS, "max_res", TOLERANCE,
                                        "lsolver", "mumps", *WHOLE_STEPS)
        assert converged
        force = np.zeros(3)
        for index, is_tool in enumerate(self.is_tool):
            force -= self.model.variable(f"h{index}").reshape(-1, 3)[is_tool].sum(axis=0)
        seconds = time.perf_counter() - start
        stress = np.concatenate([self._stress(i) for i in range(len(self.bodies))])
        return Pressed(force, stress, seconds)

    def _stress(self, index):
        """Cauchy's stress across, the mean of each cell, Pa."""
        mesh, _, rule = self.fields[index]
        of_cells = gf.MeshFem(mesh, 1)
        of_cells.set_fem(gf.Fem("FEM_PK(3,0)"))
        deformed = f"(Id(3)+Grad_u{index})"
        kirchhoff = (f"(mu{index}*({deformed}*{deformed}'-Id(3))"
                     f"+la{index}*log(Det{deformed})*Id(3))(3,3)")
        means = [self.model.local_projection(rule, text, of_cells)
                 for text in (kirchhoff, f"Det{deformed}")]
        return (means[0] / means[1])[of_cells.basic_dof_from_cvid()[0]]


# Cases --------------------------------------------------------------------------------------------


def percent(value, beside):
    return 100 * (value / beside - 1)


def check_one_body():
    """Prints how much the codes differ on a body that touches nothing."""
    body = make_cap(1 / PAIR_RADIUS, YOUNG)
    body.tool = body.touching & (np.linalg.norm(body.points, axis=1) < TIP_RADIUS)
    ours = Ours([body], POISSON).press(TIP_WAY)
    theirs = OfGetFEM([body], POISSON).press(TIP_WAY)
    for name, a, b in (("forces", ours.force, theirs.force),
                       ("stresses", ours.stress, theirs.stress)):
        print(f"One body alone: {name} differ by {abs(a - b).max() / abs(b).max():.0e} of the "
              "largest.")


def down(approach, gap):
    return 0, 0, -approach - gap


class Curve:
    """Forces (N) and seconds from rest in GetFEM, by the steps of the approach."""

    def __init__(self, bodies, gap):
        getfem = OfGetFEM(bodies, POISSON)
        getfem.touch()
        self.steps = np.arange(NUM_STEPS + 1)
        states = [getfem.press(down(steps * STEP, gap)) for steps in self.steps[1:]]
        self.forces = np.array([0] + [-state.force[2] for state in states])
        self.seconds = np.cumsum([0] + [state.seconds for state in states])
        self.smooth = Polynomial.fit(self.steps[1:], self.forces[1:] ** (1 / HERTZ), DEGREE)

    def stiffness(self, force):
        """Where the force is this, N/m."""
        root = force ** (1 / HERTZ)
        steps = brentq(lambda x: self.smooth(x) - root, self.steps[1], self.steps[-1])
        return HERTZ * force / root * self.smooth.deriv()(steps) / STEP


def edges_in_contact(force, lower, upper):
    """Hertz's radius of contact."""
    compliance = (1 - POISSON**2) * (1 / lower.young + 1 / upper.young)
    return np.cbrt(0.75 * force * PAIR_RADIUS * compliance) / EDGE


def print_round(name, lower, upper, layers):
    """Rows of a pair of round bodies, whose upper one is no softer than the lower one."""
    curve = Curve([lower, above(upper, layers[0])], layers[0])
    for layer in layers:
        ours = Ours([lower, above(upper, layer)], POISSON, layer)
        for steps in COMPARED:
            state = ours.press(down(steps * STEP, layer))
            force, hard = -state.force[2], (state.of_layer - state.force)[2]
            there, stiffness = curve.forces[steps], curve.stiffness(force)
            print(f"| {name} | {layer / EDGE:g} | {state.unknowns} | {1e3 * steps * STEP:.1f} | "
                  f"{edges_in_contact(force, lower, upper):.1f} | {1e3 * force:.2f} | "
                  f"{1e3 * hard:.2f} | {1e3 * there:.2f} | {percent(hard, there):+.1f} | "
                  f"{state.stiffness:.2f} | {stiffness:.2f} | "
                  f"{percent(state.stiffness, stiffness):+.1f} | {state.seconds:.0f} | "
                  f"{curve.seconds[steps]:.0f} |", flush=True)


def scatter(stress, chosen):
    """How far the stress of the chosen cells is from its mean, % of it: rms and largest."""
    off = percent(stress[chosen], stress[chosen].mean())
    return f"{np.sqrt(np.mean(off**2)):.2f}, {abs(off).max():.2f}"


def print_flat(layer):
    """A row of two blocks."""
    bodies = [make_block(LOWER_DIVISIONS, YOUNG), above(make_block(UPPER_DIVISIONS, YOUNG), layer)]
    ours = Ours(bodies, 0.0, layer, as_one=False).press(down(BLOCK_STEPS * STEP, layer))
    getfem = OfGetFEM(bodies, 0.0)
    getfem.touch()
    for steps in range(1, BLOCK_STEPS + 1):
        theirs = getfem.press(down(steps * STEP, layer))
    middles = np.concatenate([body.points[body.cells[:, :4]].mean(axis=1) for body in bodies])
    is_middle = abs(middles[:, :2]).max(axis=1) < MIDDLE * SIDE / 2
    stresses = [scatter(state.stress, chosen) for chosen in (is_middle, np.ones_like(is_middle))
                for state in (ours, theirs)]
    force, hard, there = -ours.force[2], (ours.of_layer - ours.force)[2], -theirs.force[2]
    print(f"| {layer / BLOCK_EDGE:g} | {ours.unknowns} | {1e3 * BLOCK_STEPS * STEP:.1f} | "
          f"{1e3 * force:.2f} | {1e3 * hard:.2f} | {1e3 * there:.2f} | "
          f"{percent(hard, there):+.1f} | " + " | ".join(stresses) + " |", flush=True)


def print_head(*titles):
    print("\n| " + " | ".join(titles) + " |\n" + "|---" * len(titles) + "|", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--layers", type=float, nargs="+", default=[0.2, 0.1],
                        help="of our contact, in edges of the mesh where the bodies touch")
    arguments = parser.parse_args()
    gf.util_trace_level(0)
    check_one_body()
    print_head("bodies", "layer", "unknowns", "approach, mm", "edges in a", "force, mN: ours",
               "without the layer", "GetFEM", "off, %", "k at equal force, N/m: ours", "GetFEM",
               "off, %", "s: ours", "GetFEM")
    layers = [EDGE * layer for layer in arguments.layers]
    curvature, turn = 1 / PAIR_RADIUS, np.pi / SECTORS
    print_round("two spheres", make_cap(curvature / 2, YOUNG),
                make_cap(curvature / 2, YOUNG, turn), layers)
    print_round("sphere on block", make_cap(0, YOUNG), make_cap(curvature, YOUNG, turn), layers)
    print_round("the same, the sphere four times as stiff", make_cap(0, YOUNG),
                make_cap(curvature, STIFFER * YOUNG, turn), layers)
    print_head("layer", "unknowns", "approach, mm", "force, mN: ours", "without the layer",
               "GetFEM", "off, %", "stress across in the middle, %: ours", "GetFEM",
               "everywhere: ours", "GetFEM")
    for layer in arguments.layers:
        print_flat(BLOCK_EDGE * layer)


if __name__ == "__main__":
    main()
