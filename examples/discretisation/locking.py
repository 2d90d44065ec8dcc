# SPDX-License-Identifier: BSD-3-Clause
"""How much too stiff a nearly incompressible body becomes, and what the mixed formulation mends."""
import os

import numpy as np
from paraview.simple import *
from vtkmodules.vtkCommonDataModel import VTK_TETRA, vtkUnstructuredGrid

from bodies import corners_of, save_body
from charts import Curve, chart
from measure import Measured
from pipeline import Failure, output, update
from tables import OUTCOMES, markdown, save_csv, vtk_table

RATIOS = (0.3, 0.45, 0.49, 0.499, 0.4999)
COLUMNS = {"Poisson's ratio": "s", "element": "s", "formulation": "s", "unknowns": ".0f",
           "force (N)": ".4g", "seconds": ".2g", "outcome": "s"}
# Shear modulus 2 (C10 + C01) of 3448 Pa, whatever Poisson's ratio.
C10, C01 = 1293.103448275862, 431.0344827586207


def bulk_modulus(ratio):
    shear = 2 * (C10 + C01)
    return 2 * shear * (1 + ratio) / (3 * (1 - 2 * ratio))


def linear(grid):
    """The same tetrahedra without their midside nodes; the points keep their ids."""
    copy = vtkUnstructuredGrid()
    copy.SetPoints(grid.GetPoints())
    for cell in corners_of(grid):
        copy.InsertNextCell(VTK_TETRA, 4, cell.tolist())
    copy.GetPointData().ShallowCopy(grid.GetPointData())
    return copy


def cases():
    """Law, settings, Poisson's ratio and formulation of each row."""
    for ratio in RATIOS:
        for formulation in ("Displacement", "Mixed"):
            yield ("Mooney-Rivlin", {"BulkModulus": bulk_modulus(ratio),
                                     "Formulation": formulation}, f"{ratio:g}", formulation)
    yield "Mooney-Rivlin incompressible", {}, "0.5", "Mixed"


def report(args):
    if not os.path.isfile(args.locking):
        raise Failure(f"there is no file {args.locking}.")
    quadratic = update(XMLUnstructuredGridReader(FileName=[args.locking]))
    bodies = {"Tet4": save_body(linear(output(quadratic)),
                                os.path.join(args.output, "linear.vtu")), "Tet10": quadratic}
    direction, length = np.array(args.pull[:3]), args.pull[3]
    displacement = length * direction / np.linalg.norm(direction)
    rows = []
    for element, body in bodies.items():
        for law, settings, ratio, formulation in cases():
            scene = AssignMaterial(Input=body, Law=law, C10=C10, C01=C01, **settings)
            solved = Measured(scene, displacement, ActiveNodes=[args.node])
            outcome = solved.figure("Outcome")
            rows.append({"Poisson's ratio": ratio, "element": element, "formulation": formulation,
                         "unknowns": solved.figure("Unknowns"), "seconds": solved.seconds,
                         "outcome": OUTCOMES[outcome],
                         "force (N)": np.linalg.norm(solved.force) if outcome == 0 else None})
            solved.forget()
            Delete(scene)
    save_csv(vtk_table(rows, COLUMNS), os.path.join(args.output, "locking.csv"))
    text = markdown(rows, COLUMNS)
    with open(os.path.join(args.output, "locking.md"), "w", encoding="utf-8") as file:
        file.write(text + "\n")
    print(text, flush=True)
    if os.environ.get("DISPLAY"):
        draw(rows, os.path.join(args.output, "locking.png"))


def draw(rows, path):
    """Force against the distance of Poisson's ratio from 0.5."""
    curves = [Curve(f"{element}, {formulation.lower()}",
                    [(0.5 - float(row["Poisson's ratio"]), row["force (N)"]) for row in rows
                     if row["element"] == element and row["formulation"] == formulation
                     and row["Poisson's ratio"] != "0.5" and row["force (N)"]],
                    number, style)
              for style, element in enumerate(("Tet4", "Tet10"))
              for number, formulation in enumerate(("Displacement", "Mixed"))]
    chart("Locking", "0.5 - Poisson's ratio", "force (N)", curves, path)
