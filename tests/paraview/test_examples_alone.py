# SPDX-License-Identifier: BSD-3-Clause
"""The examples that one rank runs, at a reduced size; the others: test_examples.py.

Argument: pvbatch.
"""

import math
import os

from examples_support import expect_pictures, rows_of, run


def check_locking(scene):
    done = run(1, "--locking", scene, "--output", "locking", example="discretisation",
               script="elements")
    assert done.returncode == 0, done.stderr
    rows = rows_of("locking/locking.csv")
    force = {(row["Poisson's ratio"], row["element"], row["formulation"]): float(row["force (N)"])
             for row in rows if row["outcome"] == "converged"}
    assert len(force) == len(rows) == 22
    # Of another code, with the same points of integration.
    assert math.isclose(force["0.45", "Tet10", "Displacement"], 0.67644, rel_tol=1e-4)
    for element, locks in (("Tet10", 1.5), ("Tet4", 20)):
        soft = force["0.5", element, "Mixed"]
        assert force["0.4999", element, "Displacement"] > locks * soft, force
        assert math.isclose(force["0.4999", element, "Mixed"], soft, rel_tol=5e-3), force
    expect_pictures("locking", "locking")


def check_discretisation():
    """A liver of coarse cells."""
    small = ["--elements", "300", "--tip-radius", "0.02", "--depth", "0.3", "--divisions", "1",
             "--tolerances", "0.08", "--reference", "0.02", "--wanted", "50", "4"]
    done = run(1, *small, "--output", "discretisation", example="discretisation")
    assert done.returncode == 0, done.stderr
    rows = {row["divided"]: row for row in rows_of("discretisation/table.csv")}
    coarse, everywhere, needed = (rows[name] for name in ("nowhere", "everywhere", "where needed"))
    assert float(everywhere["cells"]) == 8 * float(coarse["cells"]), rows
    assert float(needed["cells"]) < float(everywhere["cells"]), rows
    assert float(needed["error (%)"]) < 8 < float(coarse["error (%)"]), rows
    for row in rows.values():
        assert 0 < float(row["left (%)"]) < 0.7 * float(row["error (%)"]), rows
        assert 0.5 < float(row["told (mN)"]) / float(row["error (mN)"]) < 1.6, rows
        assert float(row["solve (s)"]) > 0, rows
    with open("discretisation/table.md", encoding="utf-8") as file:
        text = file.read().strip()
    assert text in done.stdout and "liver: the reference has" in text, text
    expect_pictures("discretisation", "error_seconds_liver")

    done = run(1, "--touched", "0", "0", "0", "--output", "discretisation",
               "discretisation/organ_liver.vtu", "discretisation/organ_liver.vtu",
               example="discretisation")
    assert done.returncode == 1 and done.stderr.count("\n") == 1, done.stderr
    assert "--touched is a place of one organ" in done.stderr, done.stderr


def check_stability(*scene):
    small = ["--laws", "Neo-Hookean", "Neo-Hookean incompressible", "--poissons", "0.3",
             "--contrasts", "1", "1e6", "--distances", "0.01", "-0.01", "--increments", "1", "3",
             "--elements", "150", "--output", "stability", *scene]
    done = run(1, *small, example="stability")
    assert done.returncode == 0, done.stderr
    rows = rows_of("stability/stability.csv")
    assert len(rows) == 24 and {row["outcome"] for row in rows} == {"converged"}, done.stdout
    for row in rows:
        assert float(row["residual"]) <= 1e-10 and float(row["least det F"]) > 0, row
        assert math.isfinite(float(row["condition"])) and 0 < float(row["seconds"]) < 60, row
    soft, stiff = (max(float(row["condition"]) for row in rows if row["contrast"] == contrast)
                   for contrast in ("1", "1e+06"))
    assert stiff > 100 * soft, (soft, stiff)
    assert "The same equilibrium in one increment and in many" in done.stdout, done.stdout
    expect_pictures("stability", "stability")

    done = run(1, *small, "--stiff", "9", "9", "9", "0.1", example="stability")
    assert done.returncode == 1 and done.stderr.count("\n") == 1, done.stderr
    assert done.stderr.startswith("stability.py: the stiff region is empty"), done.stderr


def tolerance_rows(folder, *arguments):
    done = run(1, *arguments, "--output", folder, example="tolerance")
    assert done.returncode == 0, done.stderr
    with open(os.path.join(folder, "table.md"), encoding="utf-8") as file:
        assert file.read().strip() in done.stdout
    rows = rows_of(os.path.join(folder, "table.csv"))
    assert all(float(row["seconds"]) > 0 and 0 < float(row["MB"]) < 10 for row in rows), rows
    return rows, done.stdout


def check_tolerance():
    small = ["--elements", "150", "--points", "12"]
    rows, text = tolerance_rows("tolerance", *small, "--laws", "Fung", "--exponent", "20",
                                "--half-width", "0.025", "--tolerances", "5", "0.02",
                                "--uniform", "3", "5")
    assert [row["space"] for row in rows] == ["5 %", "0.02 %", "uniform, 3³", "uniform, 5³"], rows
    coarse, fine, three, five = rows
    assert (three["configurations"], five["configurations"]) == ("27", "125"), rows
    assert 125 <= int(coarse["configurations"]) < int(fine["configurations"]), rows
    for row in (coarse, fine):
        assert 0 < float(row["reached (%)"]) <= float(row["asked (%)"]), rows
        assert float(row["marked (%)"]) == 0, rows
    assert float(five["reached (%)"]) < 0.3 * float(three["reached (%)"]), rows
    assert "Fung: every tolerance is kept" in text, text
    expect_pictures("tolerance", "reached_asked", "error_configurations")

    # The scene of that run with a material of its own; St. Venant-Kirchhoff would invert.
    done = run(1, "tolerance/scene.vtu", *small, "--laws", "Own", example="tolerance")
    assert done.returncode == 1 and done.stderr.count("\n") == 1, done.stderr
    assert done.stderr.startswith("tolerance.py: the scene has no material"), done.stderr


def check_two_hands():
    """Two sizes of model on a coarse liver; then the same place for both tools, and no density."""
    small = ["--elements", "100", "--points", "150", "--training-paths", "2", "--time-step",
             "0.004", "--output", "two_hands"]
    done = run(1, *small, "--modes", "15", "40", example="two_hands")
    assert done.returncode == 0, done.stderr
    with open("two_hands/table.md", encoding="utf-8") as file:
        text = file.read()
    assert text.strip() in done.stdout, done.stdout
    few, many = rows_of("two_hands/table.csv")
    for column in ("all tools (%)", "motion, rms (%)", "grasp (%)"):
        assert 0 < float(many[column]) < float(few[column]), (column, few, many)
    assert float(many["grasp (%)"]) < min(2, float(many["beyond (%)"])), many
    assert float(many["trust, beyond"]) > 1.5, many
    assert 0 < float(many["step (ms)"]) <= float(many["99.9 % (ms)"]), many
    expect_pictures("two_hands", "grasped", "pulled", "let_go", "error_steps", "forces")

    for wrong, message in ((["--tip-radius", "0.1"], "no place for a second tool"),
                           (["--density", "0"], "without any nothing swings")):
        done = run(1, *small, *wrong, example="two_hands")
        assert done.returncode == 1 and done.stderr.count("\n") == 1, done.stderr
        assert done.stderr.startswith("two_hands.py: ") and message in done.stderr, done.stderr


def check_wobble():
    """More viscosity: the swinging is gone sooner, and the reduced model says so too."""
    done = run(1, "--elements", "100", "--points", "150", "--training-paths", "2", "--time-step",
               "0.004", "--modes", "30", "--viscous-times", "0.01", "0.04", "--output", "wobble",
               example="wobble")
    assert done.returncode == 0, done.stderr
    little, much = rows_of("wobble/table.csv")
    assert float(much["gone after (s)"]) < float(little["gone after (s)"]), (little, much)
    assert 0.5 < float(little["swings (1/s)"]) < 5, little
    for row in (little, much):
        assert 0 < float(row["this path, rms (%)"]) < 1, row
    expect_pictures("wobble", "motion", "pulled", "swung")
    done = run(1, "--laws", "Own", "--output", "wobble", example="wobble")
    assert done.returncode == 1 and done.stderr.startswith("wobble.py: "), done.stderr


def check_bed():
    """A coarse liver on its bed, and a slit in a coarse block."""
    done = run(1, "--edge", "0.03", "--depths", "0.01", "--output", "bed", example="bed")
    assert done.returncode == 0, done.stderr
    liver, bed, stomach = rows_of("bed/parts.csv")
    borne = [float(part["borne by the others (N)"]) for part in (liver, bed, stomach)]
    assert abs(sum(borne)) < 1e-3 and borne[0] > 0.9 * float(liver["weight (N)"]), borne
    row, = rows_of("bed/table.csv")
    assert float(row["force (N)"]) > 5 * float(row["alone (N)"]) > 0, row
    assert 0.8 < float(row["on the bed (N)"]) / float(row["force (N)"]) < 1.3, row
    expect_pictures("bed", "rest", "lying", "pressed", "pressure_lying",
                    "pressure_pressed", "force")
    done = run(1, "--edge", "0", "--output", "bed", example="bed")
    assert done.returncode == 1 and done.stderr.startswith("bed.py: "), done.stderr

    done = run(1, "--cells", "8", "4", "4", "--ways", "-0.002", "0.002", "--output", "slit",
               example="bed", script="slit")
    assert done.returncode == 0, done.stderr
    squeezed, apart, *_ = rows_of("slit/table.csv")
    assert abs(float(squeezed["less the layer (%)"])) < 12, squeezed
    assert abs(float(squeezed["thin (%)"])) < abs(float(squeezed["cut (%)"])), squeezed
    assert float(squeezed["no contact (%)"]) < -30 > float(apart["cut (%)"]), (squeezed, apart)
    assert float(apart["opens (mm)"]) > 2 and float(apart["gap (mm)"]) > 0, apart
    expect_pictures("slit", "opened", "squeezed", "pressed", "force")
    done = run(1, "--cells", "3", "3", "3", "--output", "slit", example="bed", script="slit")
    assert done.returncode == 1 and done.stderr.startswith("slit.py: "), done.stderr


def check_tear():
    """A coarse space of three stages, beside direct solves, and a lobe that tears in it."""
    small = ("--stage-spacing", "0.03", "--resolution", "3", "--half-width", "0.006", "--steps",
             "8", "--element-order", "Linear")
    done = run(1, *small, "--toughness", "0.025", "--output", "tear", example="tear")
    assert done.returncode == 0, done.stderr
    stages = rows_of("tear/stages.csv")
    assert len(stages) == 3 and all(float(stage["off (%)"]) < 3 for stage in stages), stages
    assert all(abs(float(stage["G off (%)"])) < 3 for stage in stages[1:]), stages
    pull = rows_of("tear/table.csv")
    torn = [float(row["torn (cm²)"]) for row in pull]
    assert torn == sorted(torn) and torn[-1] > 1.2 * torn[0] > 0, torn
    # Each joule is accounted for, and on the way back the torn lobe is softer.
    assert all(float(row["lost (mJ)"]) > -1e-6 for row in pull), pull
    force = [float(row["force (N)"]) for row in pull]
    assert 0 < force[12] < 0.97 * force[4], force
    expect_pictures("tear", "rest", "notched", "torn", "force", "energy")
    done = run(1, *small, "--notch", "-1", "--output", "tear", example="tear")
    assert done.returncode == 1 and done.stderr.startswith("tear.py: "), done.stderr


if os.environ.get("PALPATE_SHARED_DATA"):
    check_locking(os.path.join(os.environ["PALPATE_SHARED_DATA"], "liver_seed.vtu"))
    check_stability(os.path.join(os.environ["PALPATE_SHARED_DATA"], "liver_seed.vtu"))
check_discretisation()
check_stability()
check_tolerance()
check_two_hands()
check_wobble()
check_bed()
check_tear()
