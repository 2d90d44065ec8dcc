// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateRefineMesh.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <utility>

#include "assembly/loaded_faces.h"
#include "assembly/refined_scene.h"
#include "base/error.h"
#include "base/memory_error.h"
#include "base/quantity.h"
#include "discretisation/carried_touches.h"
#include "discretisation/mesh_adaptation.h"
#include "discretisation/mesh_error_estimate.h"
#include "equilibrium/equilibrium.h"
#include "equilibrium/tangent_solver.h"
#include "interaction/rigid_tool.h"
#include "interaction/tool_clearance.h"
#include "mesh/refinement.h"
#include "vtkDoubleArray.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateActiveNodes.h"
#include "vtkPalpateCommunicator.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateFields.h"
#include "vtkPalpateGuard.h"
#include "vtkPalpateRefinedGrid.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateToolRoute.h"
#include "vtkPointData.h"
#include "vtkTable.h"
#include "vtkUnstructuredGrid.h"

namespace
{
using palpate::InputError;

/// The progress bar is half full then.
constexpr double IterationsOfSomeMeshes = 60;

std::string Percent(double share)
{
  std::ostringstream text;
  text.precision(2);
  text << 100 * share << " %";
  return text.str();
}

/// The outward normal of the surface at each point, of unit length; 0 inside.
std::vector<palpate::Vec3> UnitNormals(const palpate::TetMesh& mesh)
{
  std::vector<palpate::Vec3> normals = palpate::normals_at(mesh, palpate::boundary_faces(mesh));
  for (palpate::Vec3& normal : normals)
  {
    normal.normalize();
  }
  return normals;
}

/// NaN where the error of a touch is not known.
double LargestError(const palpate::AdaptationRound& mesh)
{
  const bool allKnown = std::all_of(
    mesh.is_known.begin(), mesh.is_known.end(), [](char isKnown) { return isKnown != 0; });
  return allKnown ? *std::max_element(mesh.errors.begin(), mesh.errors.end())
                  : std::numeric_limits<double>::quiet_NaN();
}

vtkSmartPointer<vtkTable> TableOf(const std::vector<palpate::AdaptationRound>& meshes,
  const std::vector<double>& unknowns, const std::vector<double>& seconds)
{
  auto table = vtkSmartPointer<vtkTable>::New();
  const auto add = [&](const char* name, int components, const auto& get)
  { vtkPalpateAddColumn<vtkDoubleArray>(table, name, components, meshes, get); };
  add("Cells", 1, [](const auto& mesh, int) { return mesh.num_cells; });
  const auto number = [](double value, int) { return value; };
  vtkPalpateAddColumn<vtkDoubleArray>(table, "Unknowns", 1, unknowns, number);
  vtkPalpateAddColumn<vtkDoubleArray>(table, "Seconds", 1, seconds, number);
  const auto error = [](const palpate::AdaptationRound& mesh, int touch)
  { return mesh.errors[static_cast<std::size_t>(touch)]; };
  add("LargestMeshError", 1, [](const auto& mesh, int) { return LargestError(mesh); });
  const auto change = [](const palpate::AdaptationRound& mesh, int touch)
  { return mesh.changes[static_cast<std::size_t>(touch)]; };
  const int numTouches = static_cast<int>(meshes.front().errors.size());
  add("MeshError", numTouches, error);
  add("Change", numTouches, change);
  const auto coordinate = [](const std::vector<Eigen::VectorXd>& forces, int component)
  {
    const Eigen::VectorXd& force = forces[static_cast<std::size_t>(component / 3)];
    return force.size() > 0 ? force[component % 3] : std::numeric_limits<double>::quiet_NaN();
  };
  add("Force", 3 * numTouches,
    [&](const auto& mesh, int component) { return coordinate(mesh.forces, component); });
  add("CorrectedForce", 3 * numTouches,
    [&](const auto& mesh, int component) { return coordinate(mesh.corrected_forces, component); });
  return table;
}

/// Writes the body on the last of the meshes that came one from the other.
/// @param mesh That of the body. @param scene On the last mesh.
void WriteBody(vtkUnstructuredGrid* body, const palpate::TetMesh& mesh,
  const std::vector<palpate::Refinement>& refinements, const palpate::Scene& scene,
  vtkUnstructuredGrid* output)
{
  vtkSmartPointer<vtkUnstructuredGrid> grid = body;
  const palpate::TetMesh* last = &mesh;
  for (const palpate::Refinement& refinement : refinements)
  {
    grid = vtkPalpateRefinedGrid(grid, *last, refinement);
    last = &refinement.mesh;
  }
  output->ShallowCopy(grid);
  vtkPalpateWriteBoundaryAnew(scene, output);
}
}

vtkStandardNewMacro(vtkPalpateRefineMesh);

struct vtkPalpateRefineMesh::Touches
{
  /// Of a rigid tool the places that it is brought to, m; of a bonded one how far it is moved, m.
  std::vector<palpate::Vec3> Ends;
  palpate::RigidTool Rigid;
  palpate::EquilibriumOptions Options;
  int Threads = 1;
  std::optional<palpate::CarriedTouches> Carried;
  /// Of each mesh that was solved on.
  std::vector<double> Unknowns;
  std::vector<double> Seconds;
};

vtkPalpateRefineMesh::vtkPalpateRefineMesh()
{
  this->ActiveNodes = { 0 };
  this->TipRadius = 0.01;
  // The error of the mesh is many orders above it.
  this->Tolerance = 1e-8;
  // The meshes become larger one after the other, and the ranks cannot join in between.
  this->GroupUnknowns = std::numeric_limits<int>::max();
  this->SetNumberOfOutputPorts(2);
}

vtkPalpateRefineMesh::~vtkPalpateRefineMesh() = default;

int vtkPalpateRefineMesh::FillOutputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), port == 0 ? "vtkUnstructuredGrid" : "vtkTable");
  return 1;
}

void vtkPalpateRefineMesh::Validate(const palpate::Scene& scene) const
{
  if (this->MaximumCells < scene.body.mesh.num_cells())
  {
    throw InputError("MaximumCells is " + std::to_string(this->MaximumCells) +
      ", but the body has " + std::to_string(scene.body.mesh.num_cells()) +
      " cells already. Raise it, or mesh the body more coarsely.");
  }
  if (this->Divide == AllCells)
  {
    return;
  }
  if (!(this->Depth > 0) || !std::isfinite(this->Depth))
  {
    throw InputError("Depth is " + palpate::quantity(this->Depth, "m") +
      ". Give the depth, above 0, to which the tool is pressed.");
  }
  if (!(this->MeshTolerance > 0) || !std::isfinite(this->MeshTolerance))
  {
    std::ostringstream text;
    text << "MeshTolerance is " << this->MeshTolerance
         << ". Give the largest error of a force as a share of it, above 0: 0.05 is 5 %.";
    throw InputError(text.str());
  }
  if (scene.body.mesh.order == palpate::ElementOrder::linear)
  {
    throw InputError("The body has linear cells, whose error cannot be estimated. Choose quadratic "
                     "cells where the body is meshed (ElementOrder).");
  }
  if (!this->Tool && !(this->TipRadius > 0))
  {
    throw InputError("TipRadius is " + palpate::quantity(this->TipRadius, "m") +
      ", so that the tool holds a single point. The force on a point tends to 0 as the cells "
      "become smaller, and no mesh is fine enough for it. Give the radius of the tip, or choose a "
      "rigid Tool.");
  }
}

void vtkPalpateRefineMesh::PlaceTouches(const palpate::Scene& scene, int threads, Touches& touches)
{
  touches.Options = this->SolverOptions(threads, IterationsOfSomeMeshes);
  touches.Threads = threads;
  palpate::SettledBody atRest;
  palpate::TetMesh mesh = scene.body.mesh;
  if (scene.has_load())
  {
    const palpate::EquilibriumSolver solver(
      scene, touches.Options, this->MakeLinearSolver(scene, threads));
    const palpate::Equilibrium& rest = solver.settled();
    if (rest.outcome != palpate::Outcome::converged)
    {
      throw InputError(
        "The body finds no rest under its loads on the mesh that it has: " + rest.summary.message);
    }
    atRest = { rest.u, rest.p };
    mesh.points = palpate::points_at_rest(mesh, atRest);
  }
  const std::vector<palpate::Vec3> normals = UnitNormals(mesh);
  std::unique_ptr<palpate::ToolClearance> clearance;
  if (this->Tool)
  {
    clearance = std::make_unique<palpate::ToolClearance>(scene.body, atRest,
      palpate::make_contact(scene.body, palpate::with_defaults(touches.Rigid, scene)));
  }
  for (const palpate::Index node : vtkPalpateActiveNodes(this->ActiveNodes))
  {
    if (node >= mesh.num_points() || normals[node].isZero(0))
    {
      throw InputError("Active node " + std::to_string(node) +
        " is not on the surface of the body. Choose points of the surface (ActiveNodes).");
    }
    touches.Ends.push_back(clearance
        ? clearance->pressed(mesh.points[node], normals[node], this->Depth)
        : palpate::Vec3(-this->Depth * normals[node]));
  }
  if (touches.Ends.empty())
  {
    throw InputError("There is no place to press. Choose points of the surface (ActiveNodes).");
  }
  touches.Carried.emplace(touches.Ends.size());
}

vtkPalpateToolRoute vtkPalpateRefineMesh::RouteOf(
  const palpate::Scene& scene, const Touches& touches, std::size_t touch) const
{
  return this->Tool ? vtkPalpateContactRoute(scene, touches.Rigid, touches.Ends[touch])
                    : vtkPalpateBondedRoute(
                        scene, { this->ActiveNodes[touch] }, this->TipRadius, touches.Ends[touch]);
}

std::vector<palpate::TouchOnMesh> vtkPalpateRefineMesh::Touch(
  const palpate::Scene& scene, const palpate::MeshHints& hints, Touches& touches) const
{
  const auto start = std::chrono::steady_clock::now();
  auto linearSolver = this->MakeLinearSolver(scene, touches.Threads);
  const vtkPalpateFollowOptions follow = { 1, this->IsSolverAutomatic() && !linearSolver };
  palpate::EquilibriumSolver solver(scene, touches.Options, std::move(linearSolver));
  const palpate::MeshErrorEstimator estimator(scene, solver.assembly());
  std::vector<palpate::TouchOnMesh> result;
  for (std::size_t i = 0; i < touches.Ends.size(); ++i)
  {
    const vtkPalpateToolRoute route = this->RouteOf(scene, touches, i);
    solver.set_interaction(*route.Tool);
    std::optional<palpate::Equilibrium> state =
      touches.Carried->settle(i, route.End, hints, solver);
    if (!state)
    {
      state = vtkPalpateFollow(scene, route, follow, touches.Options, solver);
    }
    if (state->outcome == palpate::Outcome::aborted)
    {
      return {};
    }
    result.push_back(touches.Carried->tell(i, &*state, estimator, *route.Tool, scene.body.mesh));
  }
  touches.Carried->end(scene.body.mesh);
  touches.Unknowns.push_back(solver.assembly().pattern().size);
  touches.Seconds.push_back(
    std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  return result;
}

void vtkPalpateRefineMesh::Refine(const palpate::Scene& scene, Touches& touches,
  vtkUnstructuredGrid* body, vtkUnstructuredGrid* output, vtkTable* table)
{
  palpate::AdaptationOptions options;
  options.tolerance = this->MeshTolerance;
  options.max_cells = this->MaximumCells;
  const palpate::AdaptedMesh adapted = palpate::adapt_mesh(scene, options,
    [&](const palpate::Scene& on, const palpate::MeshHints& hints)
    { return this->Touch(on, hints, touches); });
  if (adapted.end == palpate::AdaptationEnd::stopped)
  {
    throw InputError("The mesh was not refined to its end, since the filter was aborted.");
  }
  WriteBody(body, scene.body.mesh, adapted.refinements, adapted.scene, output);
  const palpate::AdaptationRound& last = adapted.rounds.back();
  vtkPalpateAddField<vtkDoubleArray>(output, "MeshError", 1,
    Eigen::Map<const Eigen::VectorXd>(
      last.errors.data(), static_cast<Eigen::Index>(last.errors.size())));
  vtkPalpateAddField<vtkIntArray>(output, "MeshErrorKnown", 1,
    Eigen::Map<const Eigen::Matrix<char, Eigen::Dynamic, 1>>(
      last.is_known.data(), static_cast<Eigen::Index>(last.is_known.size()))
      .cast<int>());
  touches.Unknowns.resize(adapted.rounds.size());
  touches.Seconds.resize(adapted.rounds.size());
  table->ShallowCopy(TableOf(adapted.rounds, touches.Unknowns, touches.Seconds));
  this->WarnOf(adapted);
}

void vtkPalpateRefineMesh::DivideAll(const palpate::Scene& scene, vtkUnstructuredGrid* body,
  vtkUnstructuredGrid* output, vtkTable* table)
{
  const palpate::TetMesh& mesh = scene.body.mesh;
  std::vector<palpate::Refinement> refinements;
  refinements.push_back(palpate::refine_all(mesh));
  const palpate::Index numCells = refinements.back().mesh.num_cells();
  if (numCells > this->MaximumCells)
  {
    throw InputError("The body has " + std::to_string(numCells) +
      " cells where all are divided, and MaximumCells is " + std::to_string(this->MaximumCells) +
      ". Raise it.");
  }
  const palpate::Scene divided = palpate::refined(scene, refinements.back());
  WriteBody(body, mesh, refinements, divided, output);
  const std::vector<palpate::Index> cells = { mesh.num_cells(), numCells };
  const std::vector<long> unknowns = { palpate::count_unknowns(scene),
    palpate::count_unknowns(divided) };
  const auto number = [](auto value, int) { return static_cast<double>(value); };
  vtkPalpateAddColumn<vtkDoubleArray>(table, "Cells", 1, cells, number);
  vtkPalpateAddColumn<vtkDoubleArray>(table, "Unknowns", 1, unknowns, number);
}

void vtkPalpateRefineMesh::WarnOf(const palpate::AdaptedMesh& adapted)
{
  const palpate::AdaptationRound& last = adapted.rounds.back();
  std::ostringstream text;
  for (std::size_t i = 0; i < last.errors.size(); ++i)
  {
    text << (i == 0 ? "" : ", ");
    if (last.is_known[i] != 0)
    {
      const double error = palpate::largest_error(last, i, false);
      text << "up to " << Percent(std::fmax(error, last.changes[i]));
    }
    else
    {
      text << "not known";
    }
    text << " at the active node " << this->ActiveNodes[i];
  }
  if (adapted.end == palpate::AdaptationEnd::too_many_cells)
  {
    vtkPalpateWarn(this,
      "The mesh has " + std::to_string(last.num_cells) +
        " cells, and one that is finer would have more than MaximumCells, " +
        std::to_string(this->MaximumCells) + ". The error of the force because of the mesh is " +
        text.str() + ". Raise MaximumCells or MeshTolerance.");
  }
  if (adapted.end == palpate::AdaptationEnd::not_known)
  {
    const std::string left = adapted.left.empty()
      ? "."
      : ", and not known on the finer meshes that were tried, of up to " +
        std::to_string(adapted.left.back().num_cells) + " cells, which were left.";
    vtkPalpateWarn(this,
      "The error of the force because of the mesh is " + text.str() + left +
        " Where it is not known, the tool found no equilibrium on the last meshes, or turned "
        "cells inside out, or felt nothing, or its error is half of the force or more. Solve "
        "Equilibrium shows which it is. A smaller Depth or a larger MeshTolerance helps. At the "
        "rim of what is fixed, and of a bonded tip, strains are infinite, so that small cells "
        "there are turned inside out; a rigid Tool has no such rim.");
  }
}

int vtkPalpateRefineMesh::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  auto* output = vtkUnstructuredGrid::GetData(outputVector);
  auto* rounds = vtkTable::GetData(outputVector, 1);
  // A request that ended the run before is not for this one, and nobody else takes it back.
  this->SetAbortExecute(0);
  const auto compute = [&](palpate::Communicator& communicator)
  {
    palpate::Scene scene;
    Touches touches;
    const auto setUp = [&](vtkUnstructuredGrid* body, vtkPolyData* surface) -> const palpate::Scene&
    {
      scene = vtkPalpateSceneFromGrid(body, palpate::Vec3(this->BodyForce));
      this->Validate(scene);
      if (this->Tool && this->Divide == WhereNeeded)
      {
        touches.Rigid = this->Tool->Describe(surface);
        if (touches.Rigid.motion == palpate::ToolMotion::turned)
        {
          throw palpate::InputError("The mesh is refined for a tool that presses in one "
                                    "orientation. Choose the Motion Translated or Trocar.");
        }
      }
      return scene;
    };
    const auto solve =
      [&](vtkUnstructuredGrid* body, std::unique_ptr<palpate::LinearSolver>, int threads)
    {
      palpate::with_memory("to refine the mesh of the body",
        [&]
        {
          if (this->Divide == AllCells)
          {
            this->DivideAll(scene, body, output, rounds);
            return;
          }
          this->PlaceTouches(scene, threads, touches);
          this->Refine(scene, touches, body, output, rounds);
        });
    };
    this->SolveOnRanks(inputVector, communicator, output, setUp, solve);
  };
  this->ErrorCode =
    vtkPalpateProduce(this, output, vtkMultiProcessController::GetGlobalController(), compute);
  return 1;
}

void vtkPalpateRefineMesh::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Divide: " << this->Divide << '\n'
     << indent << "Depth: " << this->Depth << " m\n"
     << indent << "MeshTolerance: " << this->MeshTolerance << '\n'
     << indent << "MaximumCells: " << this->MaximumCells << '\n';
}
