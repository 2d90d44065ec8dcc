# SPDX-License-Identifier: BSD-3-Clause
"""Makes the states of the examples (.pvsm): pipelines to load in ParaView's window.

They read liver/liver.vtp, roof/roof.vtu, nodule/surface.vtp or bed/surface.vtp, which are made
too; that of the brain reads out/brain/labels.vti, which examples/brain/run has made before.
Argument: the name of an example.

Sample runs, in this folder, with the plugin loaded:
    xvfb-run -a pvpython make_states.py liver
    for example in liver accuracy discretisation tolerance stability cluster roof palpation \
      online two_hands wobble nodule bed tear brain; do \
      xvfb-run -a pvpython make_states.py $example; done
"""
import os
import sys
from xml.etree import ElementTree

EXAMPLES = os.path.dirname(sys.path[0])
# Of the examples that have an organ.py, that of this state.
OF_ORGAN = "brain" if sys.argv[1:] == ["brain"] else "nodule"
FOLDERS = "liver", "roof", "bed", "tear", OF_ORGAN
sys.path += [os.path.join(EXAMPLES, folder) for folder in FOLDERS]

import numpy as np
import organ
from paraview import servermanager
from paraview.simple import *

import bed
import tear
from bodies import Organ
from liver import choose_active_nodes, make_scene, parser, tetrahedralize, touches
from make_surface import make_surface
from pictures import HAND, HELD, PALE, Stage
from pipeline import save_surface, update
from roof import POISSON, TIP, YOUNG, make_roof, save_grid
from surfaces import make_surfaces

# A law with which no configuration turns inside out: none is marked.
ARGS = parser().parse_args(["--resolution", "5", "--law", "Neo-Hookean"])
# The point of liver.vtp that is farthest in front, and the way out of the body there.
NODE_IN_FRONT, OUT = 265, np.array([-0.4, 0.4, 1.0])
IN_FRONT = np.array([-0.0543, 0.0360, 0.0491])  # where it is, m
# A point below it, for a second tool.
NODE_BELOW = 277
OF_BRAIN = "brain_state.palpate"  # beside brain.palpate, which examples/brain/run makes
TIP_RADIUS, HALF_WIDTH, TOOL_RADIUS = 0.015, 0.012, 0.01  # m
PULL = 0.008  # of a lobe that tears, m


def named(**sources):
    """Gives them the names that the pipeline browser shows."""
    for name, source in sources.items():
        RenameSource(name, source)


def liver_scene(order, change=lambda material: material, Law="Neo-Hookean", **parameters):
    """Surface, body, material and boundary of the liver; `change` may put filters in between."""
    surface = update(OpenDataFile("liver.vtp"))
    body = TetrahedralizeSurface(Input=surface, ElementOrder=order, PreserveSurface=1)
    material = AssignMaterial(Input=update(body), Law=Law, **parameters)
    scene = SetBoundary(Input=change(update(material)), FixedRegion="Sphere")
    scene.FixedRegion.Center, scene.FixedRegion.Radius = [-0.03, 0.06, -0.05], 0.04
    named(Surface=surface, Body=body, Material=material, Scene=scene)
    return update(scene)


def make_liver():
    """The organ, pulled, and the points where it is held."""
    surface = save_surface(make_surface(edge_length=0.0155), "liver.vtp")
    body = tetrahedralize(surface, ARGS)
    scene = make_scene(body, ARGS)
    nodes, half_width = choose_active_nodes(scene, ARGS)
    # Without a file: nothing is left behind.
    space = update(PrecomputeStateSpace(Input=scene, ActiveNodes=nodes, HalfWidth=half_width,
                                        Resolution=ARGS.resolution))
    touch = TouchStateSpace(Input=space, ActiveNode=nodes[0],
                            Displacement=list(touches(space, nodes[0], half_width)["pull"]))
    named(**{"liver.vtp": surface, "Tetrahedralize Surface": body, "Assign Material": scene.Input,
             "Set Boundary": scene, "Precompute State Space": space, "Touch State Space": touch})
    stage = Stage(scene)
    stage.clear()
    stage.show_held()
    stage.show_touched(touch, half_width)
    return stage.view


def make_accuracy():
    """Where the force that is interpolated is wrong: test points in the box of the active node."""
    scene = liver_scene("Linear")
    space = PrecomputeStateSpace(Input=scene, ActiveNodes=[NODE_IN_FRONT], HalfWidth=HALF_WIDTH,
                                 TipRadius=TIP_RADIUS, Resolution=3)
    report = AccuracyReport(Input=update(space), TestPoints=60)
    named(Space=space, Report=report)
    update(report)
    stage = Stage(scene)
    stage.clear()
    stage.show(scene, PALE, Representation="Wireframe")
    points = stage.show(OutputPort(report, 1), PointSize=14, RenderPointsAsSpheres=1)
    error = next(array for array in OutputPort(report, 1).PointData
                 if "Error" in array.Name and "Hermite" in array.Name)
    stage.colour(points, ("POINTS", error.Name), "Error (%)", error.GetRange())
    stage.view.CameraParallelScale *= 0.5
    return stage.view


def make_discretisation():
    """Linear and quadratic cells of the same surface, pulled alike: the linear body is stiffer."""
    bodies = []
    for number, order in enumerate(("Linear", "Quadratic")):
        scene = liver_scene(order)
        solve = SolveEquilibrium(Input=scene, ActiveNodes=[NODE_IN_FRONT], TipRadius=TIP_RADIUS,
                                 Displacement=pull(0.02))
        named(**{order: solve})
        warp = WarpByVector(Input=update(solve), Vectors=["POINTS", "Displacement"])
        moved = Transform(Input=warp)
        moved.Transform.Translate = [0, -0.19 * number, 0]
        bodies.append(update(moved))
    stage = Stage(bodies[0])
    for body in bodies:
        display = stage.show(body, Representation="Surface With Edges")
        stage.colour(display, ("POINTS", "Displacement", "Magnitude"), "Displacement (m)",
                     (0, 0.015))
    ResetCamera(stage.view)
    return stage.view


def make_tolerance():
    """The configurations of a space that is refined to a tolerance, by force."""
    scene = liver_scene("Linear", Law="Fung", Exponent=20)
    space = PrecomputeStateSpace(Input=scene, ActiveNodes=[NODE_IN_FRONT], HalfWidth=HALF_WIDTH,
                                 TipRadius=TIP_RADIUS, Tolerance=0.001)
    named(Space=update(space))
    configurations = ExtractBlock(Input=space, Selectors=["//Configurations"])
    stage = Stage(scene)
    stage.clear()
    stage.show(scene, PALE, Representation="Wireframe")
    display = stage.show(update(configurations), PointSize=8, RenderPointsAsSpheres=1)
    stage.colour(display, ("POINTS", "Force", "Magnitude"), "Force (N)", (0, 6))
    stage.view.CameraParallelScale *= 0.5
    return stage.view


def make_stability():
    """A stiff sphere in the liver, which is pulled far: where cells are near to inversion."""
    def stiffen(material):
        centres = AppendLocationAttributes(Input=material)
        return update(Calculator(
            Input=centres, AttributeType="Cell Data", ResultArrayName="YoungsModulus",
            Function="if(CellCenters_X^2 + CellCenters_Y^2 + CellCenters_Z^2 < 0.035^2, 1000, 1) "
                     "* YoungsModulus"))

    scene = liver_scene("Quadratic", change=stiffen)
    solve = SolveEquilibrium(Input=scene, ActiveNodes=[NODE_IN_FRONT], TipRadius=TIP_RADIUS,
                             Displacement=pull(0.021))
    named(Solution=update(solve))
    warp = WarpByVector(Input=solve, Vectors=["POINTS", "Displacement"])
    stage = Stage(scene)
    stage.clear()
    display = stage.show(update(warp), Representation="Surface With Edges")
    stage.colour(display, ("CELLS", "MinimumDetF"), "Least det F", (1, 0.3))
    return stage.view


def make_cluster():
    """The scene of a job: what is held, and the points that may be touched."""
    scene = liver_scene("Quadratic")
    stage = Stage(scene)
    for name, colour in (("Fixed", HELD), ("Touchable", HAND)):
        chosen = Threshold(Input=scene, Scalars=["POINTS", name], LowerThreshold=1,
                           ThresholdMethod="Above Upper Threshold", UpperThreshold=1, AllScalars=0)
        stage.show(update(chosen), colour, Representation="Points", PointSize=8,
                   RenderPointsAsSpheres=1)
    return stage.view


def make_roof_touched():
    """The roof, pressed through, four times as high as it is."""
    grid, node = make_roof(1)
    body = save_grid(grid, "roof.vtu")
    scene = AssignMaterial(Input=body, Law="St. Venant-Kirchhoff", YoungsModulus=YOUNG,
                           PoissonsRatio=POISSON)
    space = PrecomputeStateSpace(Input=update(scene), ActiveNodes=[node], TipRadius=TIP,
                                 HalfWidth=0.03, Resolution=11, ForceLimit=2500)
    touch = TouchStateSpace(Input=update(space), ActiveNode=node, Displacement=[0, 0, -0.03])
    high = Transform(Input=update(touch))
    high.Transform.Scale = [1, 1, 4]
    named(**{"roof.vtu": body, "Material": scene, "Space": space, "Touch": touch})
    stage = Stage(update(high))
    stage.clear()
    stage.colour(stage.show(high), ("POINTS", "Displacement", "Z"), "Deflection (m)",
                 (0, -0.03))
    stage.view.CameraPosition = [0.8, -2.6, 12]
    stage.view.CameraFocalPoint, stage.view.CameraViewUp = [0, 0, 10.13], [0, 0, 1]
    ResetCamera(stage.view)
    return stage.view


def make_palpation():
    """A sphere in the liver, within the part of the surface that it can press."""
    scene = liver_scene("Quadratic")
    space = PrecomputeStateSpace(Input=scene, Tool="Sphere", ToolRadius=TOOL_RADIUS, Depth=0.008,
                                 Spacing=0.005, UseToolRegion=1, ToolRegion="Sphere",
                                 FileName="palpation.palpate")
    space.ToolRegion.Center, space.ToolRegion.Radius = list(IN_FRONT), 0.012
    place = list(IN_FRONT + pull(TOOL_RADIUS - 0.006))
    touch = TouchStateSpace(Input=update(space), ToolPosition=place)
    tool = Sphere(Center=place, Radius=TOOL_RADIUS, ThetaResolution=32, PhiResolution=32)
    named(Space=space, Touch=update(touch), Tool=tool)
    stage = Stage(scene)
    stage.clear()
    pressure = touch.PointData["ContactPressure"].GetRange()
    stage.colour(stage.show(touch), ("POINTS", "ContactPressure"), "Pressure (Pa)", pressure)
    stage.show(tool, PALE, Opacity=0.3)
    return stage.view


def make_online():
    """A liver whose space is explored around the hand, and the sphere where it would begin."""
    scene = liver_scene("Quadratic")
    space = PrecomputeStateSpace(Input=scene, Tool="Sphere", ToolRadius=TOOL_RADIUS, Depth=0.008,
                                 Spacing=0.008, Tolerance=0.02, BeginAt=list(IN_FRONT),
                                 Exploration="Around The Hand", FileName="online.palpate")
    tool = Sphere(Center=list(IN_FRONT + pull(TOOL_RADIUS)), Radius=TOOL_RADIUS, ThetaResolution=32,
                  PhiResolution=32)
    named(Organ=update(space), Tool=tool)
    stage = Stage(scene)
    stage.clear()
    stage.show(space)
    stage.show(tool, PALE, Opacity=0.3)
    return stage.view


def moving_liver(nodes):
    """A reduced model of a liver that swings, with tools at these points of liver.vtp."""
    scene = liver_scene("Linear", YoungsModulus=5000, PoissonsRatio=0.4, Density=1060,
                        ViscousTime=0.01)
    model = BuildReducedModel(Input=scene, ActiveNodes=nodes, TipRadius=TIP_RADIUS, Reach=0.013,
                              Modes=40, TrainingPaths=2, PathDuration=1, TestPaths=0)
    named(Model=update(model))
    stage = Stage(scene)
    stage.clear()
    stage.show(model, PALE)
    for node in nodes:
        place = model.GetClientSideObject().GetOutputDataObject(0).GetPoint(node)
        stage.show(Sphere(Center=list(place), Radius=0.02 * stage.size), HAND)
    return stage.view


def make_two_hands():
    """Two tools on the left lobe."""
    return moving_liver([NODE_IN_FRONT, NODE_BELOW])


def make_wobble():
    """One tool in front."""
    return moving_liver([NODE_IN_FRONT])


def make_nodule():
    """The liver with the nodule in it, pressed over it."""
    organ.SURFACE = os.path.basename(organ.SURFACE)
    save_surface(Organ(make_surface(), organ.FRONT, tip_radius=0.022).refined(0.02, 0.25),
                 organ.SURFACE)
    scene = organ.make_scene()
    body = scene.Input.Input
    surface, nodule = body.Input.Input
    space = PrecomputeStateSpace(Input=scene, Tool="Sphere", ToolRadius=TOOL_RADIUS, Depth=0.008,
                                 Spacing=0.005, UseToolRegion=1, ToolRegion="Sphere",
                                 FileName="nodule.palpate")
    space.ToolRegion.Center, space.ToolRegion.Radius = organ.FRONT, 0.008
    place = list(np.array(organ.FRONT) + pull(TOOL_RADIUS - 0.006))
    touch = TouchStateSpace(Input=update(space), ToolPosition=place)
    tool = Sphere(Center=place, Radius=TOOL_RADIUS, ThetaResolution=32, PhiResolution=32)
    named(Surface=surface, Nodule=nodule, Both=body.Input, Body=body, Material=scene.Input,
          Scene=scene, Space=space, Touch=update(touch), Tool=tool)
    stage = Stage(scene)
    stage.clear()
    stage.colour(stage.show(touch, Opacity=0.4), ("POINTS", "ContactPressure"), "Pressure (Pa)",
                 touch.PointData["ContactPressure"].GetRange())
    stage.show(nodule, HELD)
    stage.show(tool, PALE, Opacity=0.3)
    return stage.view


def make_bed():
    """The liver on its bed under gravity, pressed and cut open."""
    organ, surfaces = make_surfaces(0.024, TOOL_RADIUS)
    surface = save_surface(surfaces, "surface.vtp")
    body = TetrahedralizeSurface(Input=surface, ElementOrder="Quadratic", PreserveSurface=1)
    scene = bed.make_scene(update(body))
    place = [*organ.place[:2], organ.place[2] + TOOL_RADIUS - 0.04]
    solve = SolveEquilibrium(Input=scene, Tool="Sphere", ToolRadius=TOOL_RADIUS, ToolPosition=place,
                             BodyForce=bed.WEIGHT, Increments=2)
    warp = WarpByVector(Input=update(solve), Vectors=["POINTS", "Displacement"])
    cut = Clip(Input=warp, ClipType="Plane", Invert=0)
    cut.ClipType.Origin, cut.ClipType.Normal = [0, place[1] - 0.002, 0], [0, 1, 0]
    tool = Sphere(Center=place, Radius=TOOL_RADIUS, ThetaResolution=32, PhiResolution=32)
    stomach, liver = scene, scene.Input
    named(Surface=surface, Body=body, Material=liver.Input.Input, Bed=liver.Input, Liver=liver,
          Stomach=stomach, Solution=solve, Deformed=warp, Cut=update(cut), Tool=tool)
    stage = Stage(scene)
    Delete(GetDisplayProperties(scene, stage.view))  # What is hidden would be in the state too.
    stage.view.CameraViewUp = [0, 0, 1]
    stage.view.CameraPosition = list(np.array(stage.view.CameraFocalPoint) + [-0.15, -1, 0.45])
    largest = float(f"{warp.PointData['PartPressure'].GetRange()[1]:.2g}")
    stage.colour(stage.show(cut), ("POINTS", "PartPressure"), "Pressure (Pa)", (0, largest))
    stage.show(tool, HAND)
    return stage.view


def make_tear():
    """The left lobe, pulled and half torn."""
    surface = update(OpenDataFile("liver.vtp"))
    body = TetrahedralizeSurface(Input=surface, ElementOrder="Linear", PreserveSurface=1)
    scene = tear.make_scene(update(body), 0.03)
    node = tear.pulled_node(scene)
    space = PrecomputeStateSpace(Input=scene, ActiveNodes=[node], TipRadius=tear.TIP_RADIUS,
                                 HalfWidth=PULL, Resolution=3)
    touch = TouchStateSpace(Input=update(space), ActiveNode=node, TornArea=0.002,
                            Displacement=list(PULL * tear.DIRECTION))
    material = scene.Input
    named(**{"liver.vtp": surface}, Body=body, Sheet=material.Input.Sheet, Cut=material.Input,
          Material=material, Scene=scene, Space=space, Touch=update(touch))
    stage = Stage(scene)
    Delete(GetDisplayProperties(scene, stage.view))  # What is hidden would be in the state too.
    stage.view.CameraPosition = list(np.array(stage.view.CameraFocalPoint) + tear.FROM)
    stage.show_touched(touch, PULL)
    return stage.view


def make_brain():
    """The brain, cut open where a sphere presses it."""
    labels = XMLImageDataReader(FileName=["labels.vti"])
    body = update(organ.fill(labels, 0.035))
    scene = update(organ.hold(body))
    space = PrecomputeStateSpace(Input=scene, Tool="Sphere", UseToolRegion=1, ToolRegion="Sphere",
                                 FileName=OF_BRAIN,
                                 **{**organ.PRESSED, "Depth": 0.003, "Spacing": 0.01})
    space.ToolRegion.Center, space.ToolRegion.Radius = organ.FRONT, 0.005
    radius = organ.PRESSED["ToolRadius"]
    out = np.array(organ.OUT) / np.linalg.norm(organ.OUT)
    place = list(np.array(organ.FRONT) + (radius - 0.003) * out)
    touch = TouchStateSpace(Input=update(space), ToolPosition=place)
    tool = Sphere(Center=place, Radius=radius, ThetaResolution=32, PhiResolution=32)
    cut = Clip(Input=body, ClipType="Plane")
    cut.ClipType.Origin, cut.ClipType.Normal = organ.FRONT, [0, 1, 0]
    named(**{"labels.vti": labels}, Body=body, Material=scene.Input, Scene=scene, Space=space,
          Touch=update(touch), Tool=tool, Cut=cut)
    stage = Stage(scene)
    Delete(GetDisplayProperties(scene, stage.view))  # What is hidden would be in the state too.
    stage.view.CameraViewUp = organ.UP
    stage.view.CameraPosition = list(np.array(stage.view.CameraFocalPoint) + [-0.3, 0.9, 0.35])
    stage.colour(stage.show(cut), ("CELLS", "RegionId"), "1 grey, 2 white", (1, 2))
    stage.show(touch, PALE, Representation="Wireframe")
    stage.show(tool, PALE)
    ResetCamera(stage.view)
    return stage.view


def pull(length):
    return list(length * OUT / np.linalg.norm(OUT))


def has_default(element, proxy):
    """Whether a <Property> holds what `proxy`, which is new, has by itself."""
    if element.find(".//Proxy") is not None:
        return False
    values = [child.get("value") for child in element.findall("Element")]
    new = proxy.GetProperty(element.get("name"))
    if not hasattr(new, "GetElement"):
        return not values
    return values == [str(new.GetElement(i)) for i in range(new.GetNumberOfElements())] or (
        len(values) == new.GetNumberOfElements() and all(
            is_number(value) and float(value) == new.GetElement(i)
            for i, value in enumerate(values)))


def is_number(text):
    try:
        return float(text) is not None
    except ValueError:
        return False


def trim(root):
    """Leaves out what a new proxy has by itself, and domains but those that hold proxies."""
    manager = servermanager.ProxyManager().SMProxyManager
    for proxy in root.iter("Proxy"):
        if not proxy.get("type"):
            continue
        new = manager.NewProxy(proxy.get("group"), proxy.get("type"))
        for element in proxy.findall("Property"):
            if has_default(element, new):
                proxy.remove(element)
            for domain in element.findall("Domain"):
                if domain.find("Proxy") is None:
                    element.remove(domain)
        new.UnRegister(None)


def save(path):
    SaveState(path)
    tree = ElementTree.parse(path)
    trim(tree.getroot())
    ElementTree.indent(tree)
    tree.write(path, encoding="utf-8", xml_declaration=True)


MAKERS = {"liver": make_liver, "accuracy": make_accuracy, "discretisation": make_discretisation,
          "tolerance": make_tolerance, "stability": make_stability, "cluster": make_cluster,
          "roof": make_roof_touched, "palpation": make_palpation, "online": make_online,
          "two_hands": make_two_hands, "wobble": make_wobble, "nodule": make_nodule,
          "bed": make_bed, "tear": make_tear, "brain": make_brain}
# Where what they read is, if it is not that of the liver.
DATA = {"roof": "roof", "nodule": "nodule", "bed": "bed",
        "brain": os.path.join("..", "out", "brain")}


def main(name):
    # No folder in the names of files: they are looked for in one that the user names.
    os.chdir(os.path.join(EXAMPLES, DATA.get(name, "liver")))
    view = MAKERS[name]()
    # ParaView's window shows no view without a place in a layout.
    AssignViewToLayout(view=view, layout=CreateLayout(name.capitalize()))
    Render(view)
    save(os.path.join(EXAMPLES, name, f"{name}.pvsm"))
    if os.environ.get("PALPATE_STATE_PICTURES"):
        SaveScreenshot(os.path.join(os.environ["PALPATE_STATE_PICTURES"], name + ".png"), view,
                       ImageResolution=[600, 450])
    left = OF_BRAIN if name == "brain" else name + ".palpate"
    if os.path.exists(left):
        os.remove(left)


main(*sys.argv[1:])
