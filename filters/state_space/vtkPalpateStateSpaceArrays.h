// SPDX-License-Identifier: BSD-3-Clause
// The names of the blocks and arrays of a state space as VTK's data, and their contents. The list
// is at the head of vtkPalpateStateSpace.h.
#pragma once

#include <string>
#include <vector>

#include "base/outcome.h"
#include "base/types.h"
#include "state_space/tool_space_key.h"

class vtkPartitionedDataSetCollection;

namespace vtkPalpateStateSpaceArrays
{
constexpr const char* BlockNames[] = { "Body", "Surface", "Configurations", "IntermediateStates" };
constexpr const char* ThirdDerivative = "ThirdDerivative";
constexpr const char* MeshError = "MeshError";
constexpr const char* MeshErrorEnergy = "MeshErrorEnergy";
constexpr const char* MeshErrorReliable = "MeshErrorReliable";
constexpr const char* FileName = "FileName";
constexpr const char* LevelsReached = "LevelsReached";

/// The arrays of a space of several bodies: the body of each configuration and intermediate state,
/// and of each tool space the body and the material point (m).
constexpr const char* BodyNumber = "BodyNumber";
constexpr const char* BodyNumbers = "BodyNumbers";
constexpr const char* MaterialPoints = "MaterialPoints";

/// Field arrays of the surface of an organ that is cut: of each of its last triangles, which are
/// the sides of the cut, the stage at which it opens; and of each stage the body and the area (m²).
constexpr const char* StageOfSide = "StageOfSide";
constexpr const char* StagesOfCut = "StagesOfCut";

/// The numbers of the blocks of a name, which others than we may have made several of.
std::vector<unsigned int> FindBlocks(
  vtkPartitionedDataSetCollection* collection, const std::string& name);

/// The name of the block of a body: "Body", "Body2", … A selector of blocks knows no spaces.
inline std::string BodyBlockName(palpate::BodyId body)
{
  return BlockNames[0] + (body == palpate::kFirstBody ? "" : std::to_string(body));
}

/// The name of the array of an active node's modes. If there is only one active node, the name has
/// no number.
inline std::string ModesName(bool isOnly, const palpate::ToolSpaceKey& key)
{
  return isOnly ? "Modes"
                : "Modes " + std::to_string(key.id) +
      (key.body == palpate::kFirstBody ? "" : " of Body " + std::to_string(key.body));
}

/// Calls visit(name, components, get) for every figure of a configuration that is a double;
/// get(configuration) gives the first of them.
template <class Visit>
void ForEachDoubleArray(Visit&& visit)
{
  visit("Displacement", 3, [](auto& c) { return c.t.data(); });
  visit("Force", 3, [](auto& c) { return c.force.data(); });
  visit("Energy", 1, [](auto& c) { return &c.energy; });
  visit("Stiffness", 9, [](auto& c) { return c.stiffness.data(); }); // symmetric
  visit("Residual", 1, [](auto& c) { return &c.residual; });
  visit("MinimumDetF", 1, [](auto& c) { return &c.minimum_det_f; });
  visit("Seconds", 1, [](auto& c) { return &c.seconds; });
}

/// The same for the figures that are integers.
template <class Visit>
void ForEachIntArray(Visit&& visit)
{
  static_assert(sizeof(palpate::Outcome) == sizeof(int));
  visit("CheckPoint", 3, [](auto& c) { return c.check_point.data(); });
  visit("ParentCheckPoint", 3, [](auto& c) { return c.parent.data(); });
  visit("Level", 1, [](auto& c) { return &c.level; });
  visit("ParentLevel", 1, [](auto& c) { return &c.parent_level; });
  visit("Flags", 1, [](auto& c) { return &c.flags; });
  visit("NegativePivots", 1, [](auto& c) { return &c.negative_pivots; });
  visit("Iterations", 1, [](auto& c) { return &c.iterations; });
}

/// The same for the figures of an intermediate state that are doubles.
template <class Visit>
void ForEachDoubleArrayOfStates(Visit&& visit)
{
  visit("Displacement", 3, [](auto& s) { return s.t.data(); });
  visit("Force", 3, [](auto& s) { return s.force.data(); });
  visit("Energy", 1, [](auto& s) { return &s.energy; });
  visit("Seconds", 1, [](auto& s) { return &s.seconds; });
}

/// The same for the figures that are integers.
template <class Visit>
void ForEachIntArrayOfStates(Visit&& visit)
{
  visit("TargetCheckPoint", 3, [](auto& s) { return s.target.data(); });
  visit("Number", 1, [](auto& s) { return &s.number; });
  visit("Flags", 1, [](auto& s) { return &s.flags; });
}

/// Calls visit(name, value) for each field array that has a value for each tool space, except for
/// the active nodes themselves.
/// @tparam ToolSpaceSetup palpate::ToolSpaceSetup, or const.
template <class ToolSpaceSetup, class Visit>
void VisitSetup(ToolSpaceSetup&& setup, Visit&& visit)
{
  visit("TipRadius", setup.interaction.tip_radius);
  visit("HalfWidth", setup.grid.half_width);
  visit("Resolution", setup.grid.resolution);
  visit("ForceLimit", setup.policy.force_limit);
  visit("CoarsestCell", setup.grid.coarsest);
  visit("Tolerance", setup.policy.tolerance);
  visit("ToleranceIsRelative", setup.policy.tolerance_is_relative);
  visit("History", setup.policy.history);
  visit("IntermediateStates", setup.policy.intermediate_states);
  visit("ThirdDerivatives", setup.policy.third_derivatives);
}

/// The same for the field arrays that a space has only if its tool is rigid.
template <class ToolSpaceSetup, class Visit>
void VisitContact(ToolSpaceSetup&& setup, Visit&& visit)
{
  auto& tool = setup.interaction.tool;
  visit("ToolShape", tool.shape);
  visit("ToolRadius", tool.radius);
  visit("ToolAxisX", tool.axis[0]);
  visit("ToolAxisY", tool.axis[1]);
  visit("ToolAxisZ", tool.axis[2]);
  visit("ToolLength", tool.length);
  visit("ContactThickness", tool.law.thickness);
  visit("ContactStiffness", tool.law.stiffness);
  visit("GridOriginX", setup.grid.origin[0]);
  visit("GridOriginY", setup.grid.origin[1]);
  visit("GridOriginZ", setup.grid.origin[2]);
  visit("Depth", setup.policy.depth);
}

/// The arrays of a space with regions, for each tool space: the numbers of palpate::MeshRegion. A
/// tool space that is for the whole organ has a negative tolerance.
constexpr const char* RegionCentre = "RegionCentre";
template <class MeshRegion, class Visit>
void VisitRegion(MeshRegion&& region, Visit&& visit)
{
  visit("RegionBand", region.band);
  visit("RegionSize", region.size);
  visit("RegionTolerance", region.tolerance);
}

/// The name of the array of offsets, which spaces of earlier versions do not have.
constexpr const char* ContactOffset = "ContactOffset";
/// The name of the array of derivatives by all coordinates of a tool that is turned; NaN where it
/// touches nothing.
constexpr const char* TurnDerivatives = "TurnDerivatives";
/// The names of the field arrays of the tool's motion, if it is not translated: its kind, and the
/// numbers of each tool space.
constexpr const char* ToolMotion = "ToolMotion";
constexpr const char* MotionNumbers = "MotionNumbers";
/// The names of the field arrays of the tool's surface, if the tool is one.
constexpr const char* ToolPoints = "ToolPoints";
constexpr const char* ToolTriangles = "ToolTriangles";
}
