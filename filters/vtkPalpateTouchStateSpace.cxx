// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateTouchStateSpace.h"

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "assembly/assembly.h"
#include "base/error.h"
#include "interpolation/body_field.h"
#include "interpolation/display_field.h"
#include "interpolation/interpolator.h"
#include "interpolation/solution_branches.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateCommunicator.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateInput.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateStateSpace.h"
#include "vtkPalpateStress.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTriangleMeshPointNormals.h"
#include "vtkUnstructuredGrid.h"

namespace
{
using palpate::Index;
using palpate::TouchSpace;
using palpate::TouchToolSpace;

/// @throws palpate::InputError the node is not in the space; it says which are.
const TouchToolSpace& SiteOf(const TouchSpace& space, vtkIdType node)
{
  if (space.tool_spaces.empty())
  {
    throw palpate::InputError("The state space has no active node. Compute it again.");
  }
  const auto isBonded = [](const TouchToolSpace& toolSpace)
  { return !toolSpace.setup.interaction.is_contact(); };
  if (!std::all_of(space.tool_spaces.begin(), space.tool_spaces.end(), isBonded))
  {
    throw palpate::InputError("The state space is that of a rigid tool, which this filter does not "
                              "move. Give it a space of active nodes, or press the body with the "
                              "tool by Solve Equilibrium.");
  }
  if (node == -1)
  {
    return space.tool_spaces.front();
  }
  const auto index = static_cast<palpate::Index>(node);
  if (const TouchToolSpace* toolSpace = space.find(index); toolSpace && index == node)
  {
    return *toolSpace;
  }
  constexpr std::size_t mostNamed = 10;
  std::string nodes;
  for (std::size_t i = 0; i < std::min(mostNamed, space.tool_spaces.size()); ++i)
  {
    nodes +=
      (i == 0 ? "" : ", ") + std::to_string(space.tool_spaces[i].setup.interaction.active_node);
  }
  if (space.tool_spaces.size() > mostNamed)
  {
    nodes += ", …";
  }
  throw palpate::InputError("Active node " + std::to_string(node) +
    " is not in the state space, which has " + std::to_string(space.tool_spaces.size()) + ": " +
    nodes + ". Choose one of them, or compute the space for this one.");
}

void AddVector(vtkDataObject* output, const char* name, int components, const double* values)
{
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->InsertNextTuple(values);
  output->GetFieldData()->AddArray(array);
}

/// What takes more than the surface.
struct WholeBodyOf
{
  explicit WholeBodyOf(const TouchSpace& space)
    : Fields(space.file, space.scene_hash)
  {
    if (space.file.empty())
    {
      throw palpate::InputError("Stress and the whole body need the displacement of every point, "
                                "which is kept in a file alone: give Precompute State Space a "
                                "FileName.");
    }
    this->Scene = this->Fields.read_scene();
    this->Rest = vtkPalpateGridFromScene(this->Scene);
  }

  palpate::FieldCache Fields;
  palpate::Scene Scene;
  vtkSmartPointer<vtkUnstructuredGrid> Rest;
  /// Made when stress is first asked for.
  std::optional<palpate::Assembly> Assembly;
};
}

struct vtkPalpateTouchStateSpace::Prepared
{
  vtkMTimeType InputTime = 0;
  TouchSpace Space;
  vtkNew<vtkCellArray> Triangles;
  /// A branch of a tool space. The parts are made when they are first needed.
  struct Branch
  {
    std::map<int, std::unique_ptr<palpate::Interpolator>> Interpolators;
    std::unique_ptr<palpate::DisplayField> Field;
    std::unique_ptr<palpate::BodyField> BodyField;
  };
  std::map<vtkIdType, palpate::SolutionBranches> BranchesOfNode;
  std::map<std::pair<vtkIdType, int>, Branch> Branches;
  /// Which of the branches was asked for.
  vtkIdType Node = -1;
  int OnBranch = 0;
  /// As long as it is asked for.
  std::unique_ptr<WholeBodyOf> Whole;
  /// Why there is none, as told.
  std::string Problem;

  /// The branch that the body is on when the node has come to t.
  /// @param start Where it came from, in a straight line.
  /// @param startBranch The branch that it was on there; -1: that to which it comes from rest.
  /// @param branch The branch that it is on at t; -1: to be found.
  /// @throws InputError there is no such branch.
  Branch& Find(const TouchToolSpace& toolSpace, const palpate::Vec3& start, int startBranch,
    const palpate::Vec3& t, int branch)
  {
    this->Node = toolSpace.setup.interaction.active_node;
    const palpate::SolutionBranches& branches =
      this->BranchesOfNode.try_emplace(this->Node, toolSpace).first->second;
    for (const int given : { startBranch, branch })
    {
      if (given < -1 || given >= branches.size())
      {
        throw palpate::InputError("There is no branch " + std::to_string(given) +
          " at active node " + std::to_string(this->Node) + ": it has " +
          std::to_string(branches.size()) +
          ", counted from 0. Choose one of them, or -1, with which the body finds its own.");
      }
    }
    if (branch < 0 && startBranch < 0)
    {
      startBranch = branches.move(0, palpate::Vec3::Zero(), start);
    }
    this->OnBranch = branch >= 0 ? branch : branches.move(startBranch, start, t);
    return this->Branches[{ this->Node, this->OnBranch }];
  }

  /// What of the tool space is on a branch; its parts hold all they need of it.
  [[nodiscard]] TouchToolSpace SiteOnBranch(const TouchToolSpace& toolSpace, int branch) const
  {
    return palpate::restricted(toolSpace,
      this->BranchesOfNode.at(toolSpace.setup.interaction.active_node).configurations(branch));
  }
};

vtkStandardNewMacro(vtkPalpateTouchStateSpace);

vtkPalpateTouchStateSpace::vtkPalpateTouchStateSpace()
{
  this->SetNumberOfOutputPorts(2);
}

vtkPalpateTouchStateSpace::~vtkPalpateTouchStateSpace() = default;

int vtkPalpateTouchStateSpace::FillInputPortInformation(int, vtkInformation* info)
{
  vtkPalpateTakeWhole(info, "vtkPartitionedDataSetCollection");
  return 1;
}

int vtkPalpateTouchStateSpace::FillOutputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), port == 0 ? "vtkPolyData" : "vtkUnstructuredGrid");
  return 1;
}

void vtkPalpateTouchStateSpace::AddWholeBody(vtkPolyData* surface, vtkUnstructuredGrid* body)
{
  Prepared& cache = *this->Cache;
  if (!cache.Whole)
  {
    cache.Whole = std::make_unique<WholeBodyOf>(cache.Space);
  }
  WholeBodyOf& whole = *cache.Whole;
  auto& field = cache.Branches[{ cache.Node, cache.OnBranch }].BodyField;
  if (!field)
  {
    field = std::make_unique<palpate::BodyField>(
      cache.SiteOnBranch(*cache.Space.find(static_cast<Index>(cache.Node)), cache.OnBranch));
  }
  palpate::NodalVector u;
  palpate::NodalVector p;
  field->evaluate(palpate::Vec3(this->Displacement), whole.Fields, u, p);
  const palpate::TetMesh& mesh = whole.Scene.mesh;
  if (u.size() == 0)
  {
    u.setZero(3 * static_cast<Eigen::Index>(mesh.num_points()));
  }
  if (this->WholeBody)
  {
    body->ShallowCopy(whole.Rest);
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    points->SetNumberOfPoints(mesh.num_points());
    for (Index point = 0; point < mesh.num_points(); ++point)
    {
      const palpate::Vec3 place = mesh.points[point] + u.segment<3>(3 * point);
      points->SetPoint(point, place.data());
    }
    body->SetPoints(points);
    body->GetPointData()->AddArray(vtkPalpateNodalArray(vtkPalpateArray::Displacement, u));
    body->GetPointData()->SetActiveVectors(vtkPalpateArray::Displacement);
  }
  if (this->Stress)
  {
    if (!whole.Assembly)
    {
      whole.Assembly.emplace(whole.Scene);
    }
    const palpate::BodyStress stress = palpate::find_stress(*whole.Assembly, mesh, u, p);
    vtkPalpateAddStress(
      stress.at_points, surface->GetPointData(), &cache.Space.surface.mesh_points);
    if (this->WholeBody)
    {
      vtkPalpateAddStress(stress.of_cells, body->GetCellData());
      vtkPalpateAddStress(stress.at_points, body->GetPointData());
    }
  }
}

int vtkPalpateTouchStateSpace::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  auto* output = vtkPolyData::GetData(outputVector);
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  this->ErrorCode = vtkPalpateProduce(this, output, controller,
    [&]
    {
      auto* input = vtkPalpateInput<vtkPartitionedDataSetCollection>(inputVector[0]);
      // Decided together: where rank 0 alone meets an error, the others must not wait for it.
      const auto ranks = vtkPalpateCommunicator(controller);
      if (palpate::any(*ranks, vtkPalpatePassFailure(input, output)))
      {
        return;
      }
      if (palpate::any(*ranks, !this->Cache || this->Cache->InputTime != input->GetMTime()))
      {
        this->Cache.reset();
        auto prepared = std::make_unique<Prepared>();
        prepared->Space = vtkPalpateSpaceFromCollection(input, controller);
        for (const auto& [a, b, c] : prepared->Space.surface.triangles)
        {
          prepared->Triangles->InsertNextCell({ a, b, c });
        }
        prepared->InputTime = input->GetMTime();
        this->Cache = std::move(prepared);
      }
      if (controller && controller->GetLocalProcessId() != 0)
      {
        return;
      }

      const TouchSpace& space = this->Cache->Space;
      const TouchToolSpace& toolSpace = SiteOf(space, this->ActiveNode);
      const vtkIdType node = toolSpace.setup.interaction.active_node;
      const palpate::Vec3 t(this->Displacement);
      Prepared::Branch& branch = this->Cache->Find(
        toolSpace, palpate::Vec3(this->StartDisplacement), this->StartBranch, t, this->Branch);
      auto& interpolator = branch.Interpolators[this->Interpolation];
      if (!interpolator)
      {
        const auto method = static_cast<palpate::Method>(this->Interpolation);
        // The stiffness at rest is that of the branch that rest is on.
        const int of = method == palpate::Method::linear ? 0 : this->Cache->OnBranch;
        interpolator = palpate::make_interpolator(method, this->Cache->SiteOnBranch(toolSpace, of));
      }
      if (!branch.Field)
      {
        branch.Field = std::make_unique<palpate::DisplayField>(
          this->Cache->SiteOnBranch(toolSpace, this->Cache->OnBranch));
      }
      const palpate::DisplayField& field = *branch.Field;

      const palpate::TouchResult touch = interpolator->evaluate(t);
      Eigen::VectorXf coefficients(field.num_modes());
      field.coefficients(t, coefficients.data());
      if (touch.support == palpate::Support::none || !coefficients.allFinite())
      {
        coefficients.setZero();
      }
      const palpate::Index numberOfPoints = space.surface.num_points();
      vtkNew<vtkFloatArray> displacement;
      displacement->SetName("Displacement");
      displacement->SetNumberOfComponents(3);
      displacement->SetNumberOfTuples(numberOfPoints);
      palpate::apply_modes(space.modes, coefficients.data(), displacement->GetPointer(0));
      vtkNew<vtkPoints> points;
      points->SetNumberOfPoints(numberOfPoints);
      for (palpate::Index p = 0; p < numberOfPoints; ++p)
      {
        const float* u = displacement->GetPointer(3 * p);
        const palpate::Vec3& x = space.surface.points[p];
        points->SetPoint(p, x[0] + u[0], x[1] + u[1], x[2] + u[2]);
      }
      output->SetPoints(points);
      output->SetPolys(this->Cache->Triangles);
      output->GetPointData()->SetVectors(displacement);
      vtkNew<vtkTriangleMeshPointNormals> normals;
      normals->SetInputData(output);
      normals->Update();
      output->GetPointData()->SetNormals(normals->GetOutput()->GetPointData()->GetNormals());
      output->GetPointData()->SetActiveScalars(displacement->GetName());

      AddVector(output, "Force", 3, touch.force.data());
      AddVector(output, "Stiffness", 9, touch.stiffness.data());
      AddVector(output, "Energy", 1, &touch.energy);
      const palpate::Vec3 position = toolSpace.setup.interaction.material_point + t;
      AddVector(output, "ActivePosition", 3, position.data());
      for (const auto& [name, value] : { std::pair("Found", static_cast<int>(touch.support)),
             std::pair("Branch", this->Cache->OnBranch) })
      {
        vtkNew<vtkIntArray> array;
        array->SetName(name);
        array->InsertNextValue(value);
        output->GetFieldData()->AddArray(array);
      }
      vtkNew<vtkIdTypeArray> active;
      active->SetName("ActiveNode");
      active->InsertNextValue(node);
      output->GetFieldData()->AddArray(active);

      if (!this->Stress && !this->WholeBody)
      {
        this->Cache->Whole.reset();
        this->Cache->Problem.clear();
        return;
      }
      try
      {
        this->AddWholeBody(output, vtkUnstructuredGrid::GetData(outputVector, 1));
        this->Cache->Problem.clear();
      }
      catch (const std::exception& error)
      {
        // What is touched goes on without; at many frames a second it is told once.
        if (this->Cache->Problem != error.what())
        {
          this->Cache->Problem = error.what();
          vtkErrorMacro(<< error.what());
        }
      }
    });
  return 1;
}

void vtkPalpateTouchStateSpace::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "ActiveNode: " << this->ActiveNode << '\n'
     << indent << "Displacement: " << this->Displacement[0] << ' ' << this->Displacement[1] << ' '
     << this->Displacement[2] << '\n'
     << indent << "StartDisplacement: " << this->StartDisplacement[0] << ' '
     << this->StartDisplacement[1] << ' ' << this->StartDisplacement[2] << '\n'
     << indent << "StartBranch: " << this->StartBranch << '\n'
     << indent << "Branch: " << this->Branch << '\n'
     << indent << "Interpolation: " << this->Interpolation << '\n'
     << indent << "Stress: " << this->Stress << '\n'
     << indent << "WholeBody: " << this->WholeBody << '\n';
}
