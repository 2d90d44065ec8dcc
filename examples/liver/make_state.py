# SPDX-License-Identifier: BSD-3-Clause
"""Makes liver.vtp and liver.pvsm: the example as a pipeline to load in ParaView's window.

Sample run, in this folder, with the plugin loaded:
    xvfb-run -a pvpython make_state.py
"""
from paraview.simple import *

from liver import choose_active_nodes, make_scene, parser, tetrahedralize, touches
from make_surface import make_surface
from pictures import Stage
from pipeline import save_surface, update

args = parser().parse_args(["--resolution", "5"])
# No folder in the name of the file: it is looked for beside the state.
surface = save_surface(make_surface(edge_length=0.0155), "liver.vtp")
body = tetrahedralize(surface, args)
scene = make_scene(body, args)
nodes, half_width = choose_active_nodes(scene, args)
# Without a file: nothing is left behind.
space = update(PrecomputeStateSpace(Input=scene, ActiveNodes=nodes, HalfWidth=half_width,
                                    Resolution=args.resolution))
touch = TouchStateSpace(Input=space, ActiveNode=nodes[0],
                        Displacement=list(touches(space, nodes[0], half_width)["pull"]))
for name, proxy in (("liver.vtp", surface), ("Tetrahedralize Surface", body),
                    ("Assign Material", scene.Input), ("Set Boundary", scene),
                    ("Precompute State Space", space), ("Touch State Space", touch)):
    RenameSource(name, proxy)

stage = Stage(scene)
stage.clear()
stage.show_held()
stage.show_touched(touch, half_width)
SetActiveSource(touch)
# ParaView's window shows no view without a place in a layout.
AssignViewToLayout(view=stage.view, layout=CreateLayout("Liver"))
SaveState("liver.pvsm")
