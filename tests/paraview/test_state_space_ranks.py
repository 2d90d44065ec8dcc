# SPDX-License-Identifier: BSD-3-Clause
"""Two ranks give the space of one to the bit, whole on rank 0; errors are met together."""

import numpy
from paraview import servermanager
from paraview.simple import (GroupDatasets, OpenDataFile, SaveData, Sphere, StateSpaceReader,
                             TouchStateSpace)
from state_space_support import expect_same_space, fetch_space, precompute
from support import Messages, field, node_at, point_array, scene

RANK = servermanager.vtkProcessModule.GetProcessModule().GetPartitionId()


def fetch_touch(source, node):
    touch = TouchStateSpace(Input=source, ActiveNode=node, Displacement=[0.003, 0.002, -0.004])
    touch.UpdatePipeline()
    return servermanager.Fetch(touch, 0)


boundary = scene("ranks")
node = node_at(boundary, [0.2, 0.1, 0.1])
# All blocks are there on both ranks.
whole = {"IntermediateStates": 1}
kept = precompute(boundary, [node], FileName="ranks.palpate", **whole)
# pvbatch runs this script on rank 0 alone: the others follow.
assert RANK == 0
in_file = fetch_space(kept)
assert field(in_file["Configurations"], "Ranks")[0] == 2
assert field(in_file["Configurations"], "Solved")[0] == 125
assert in_file["IntermediateStates"].GetNumberOfPoints() == 124
in_memory = fetch_space(precompute(boundary, [node], **whole))
expect_same_space(in_file, in_memory)
# In a group of two; 27 configurations, since two ranks of a busy machine wait for each other.
together, alone = (fetch_space(precompute(boundary, [node], Resolution=3, RanksPerSolve=ranks))
                   ["Configurations"] for ranks in (2, 1))
assert field(together, "Ranks")[0] == 2 and field(together, "Solved")[0] == 27
for name in ("Force", "Energy", "Displacement"):
    ours, theirs = (point_array(grid, name) for grid in (together, alone))
    # To the solver's tolerance: the sums are those of another order.
    assert abs(ours - theirs).max() <= 1e-7 * abs(theirs).max(), name
reader = StateSpaceReader(FileName="ranks.palpate")
expect_same_space(in_file, fetch_space(reader))
SaveData("ranks.vtpc", proxy=kept, DataMode="Binary")
stock = OpenDataFile("ranks.vtpc")
forces = [field(fetch_touch(source, node), "Force")[0] for source in (kept, reader, stock)]
assert numpy.isfinite(forces[0]).all() and numpy.linalg.norm(forces[0]) > 0
assert (forces[0] == forces[1]).all() and (forces[0] == forces[2]).all()

for settings, word in (({"Resolution": 4}, "odd"), ({"FileName": "no/such/a.palpate"}, "no/such"),
                       ({"RanksPerSolve": 3}, "from 1 to the number of ranks, 2"),
                       ({"RanksPerSolve": 0}, "ranks per solve are 0")):
    with Messages() as messages:
        precompute(boundary, [node], **settings).UpdatePipeline()
    assert messages.errors == 1 and word in messages.text, messages.text
# An input that is no state space is an error on rank 0; the others do not wait for it.
group = GroupDatasets(Input=[Sphere()])
group.OutputType = "vtkPartitionedDataSetCollection"
touch = TouchStateSpace(Input=group)
for x in (0.001, 0.002):
    touch.Displacement = [x, 0, 0]
    with Messages() as messages:
        touch.UpdatePipeline()
    assert messages.errors == 1 and "no state space" in messages.text, messages.text
print("two ranks equal one")
numpy.save("forces.npy", forces[0])
