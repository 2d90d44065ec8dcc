// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateReducedModel.h"

#include <string>

#include "base/error.h"
#include "reduced/model_arrays.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdTypeArray.h"
#include "vtkNew.h"
#include "vtkPalpateScene.h"
#include "vtkPointData.h"

namespace
{
constexpr const char* Basis = "ReducedBasis";
constexpr const char* Rest = "ReducedRest";
constexpr const char* ActiveNodes = "ActiveNodes";
const std::string Prefix = "Reduced";

/// An array with a tuple for each row.
vtkSmartPointer<vtkDoubleArray> ArrayOf(const std::string& name, const Eigen::MatrixXd& matrix)
{
  auto array = vtkSmartPointer<vtkDoubleArray>::New();
  array->SetName(name.c_str());
  array->SetNumberOfComponents(static_cast<int>(matrix.cols()));
  array->SetNumberOfTuples(matrix.rows());
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::Map<RowMajor>(array->GetPointer(0), matrix.rows(), matrix.cols()) = matrix;
  return array;
}

Eigen::MatrixXd MatrixOf(vtkDataArray* array)
{
  Eigen::MatrixXd matrix(array->GetNumberOfTuples(), array->GetNumberOfComponents());
  for (Eigen::Index row = 0; row < matrix.rows(); ++row)
  {
    for (Eigen::Index column = 0; column < matrix.cols(); ++column)
    {
      matrix(row, column) = array->GetComponent(row, static_cast<int>(column));
    }
  }
  return matrix;
}

[[noreturn]] void Refuse(const std::string& what)
{
  throw palpate::InputError(
    "The input has no reduced model: " + what + ". Use the output of Build Reduced Model.");
}
}

void vtkPalpateWriteReducedModel(const vtkPalpateReducedModel& model, vtkDataSet* body)
{
  const Eigen::Index coordinates = model.Basis.cols();
  const Eigen::Index points = model.Basis.rows() / 3;
  vtkNew<vtkDoubleArray> basis;
  basis->SetName(Basis);
  basis->SetNumberOfComponents(static_cast<int>(3 * coordinates));
  basis->SetNumberOfTuples(points);
  double* value = basis->GetPointer(0);
  for (Eigen::Index point = 0; point < points; ++point)
  {
    for (Eigen::Index coordinate = 0; coordinate < coordinates; ++coordinate)
    {
      for (int axis = 0; axis < 3; ++axis)
      {
        *value++ = model.Basis(3 * point + axis, coordinate);
      }
    }
  }
  body->GetPointData()->AddArray(basis);
  if (model.Rest.size() > 0)
  {
    body->GetPointData()->AddArray(vtkPalpateNodalArray(Rest, model.Rest));
  }
  vtkNew<vtkIdTypeArray> nodes;
  nodes->SetName(ActiveNodes);
  for (const vtkIdType node : model.ActiveNodes)
  {
    nodes->InsertNextValue(node);
  }
  body->GetFieldData()->AddArray(nodes);
  for (const auto& [name, matrix] : palpate::arrays_of(model.Model))
  {
    body->GetFieldData()->AddArray(ArrayOf(Prefix + name, matrix));
  }
}

vtkPalpateReducedModel vtkPalpateReadReducedModel(vtkDataSet* body)
{
  vtkPalpateReducedModel result;
  palpate::NamedArrays arrays;
  vtkFieldData* fields = body->GetFieldData();
  for (int i = 0; i < fields->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = fields->GetArray(i);
    const std::string name = array && array->GetName() ? array->GetName() : "";
    if (name.compare(0, Prefix.size(), Prefix) == 0)
    {
      arrays[name.substr(Prefix.size())] = MatrixOf(array);
    }
  }
  vtkDataArray* basis = body->GetPointData()->GetArray(Basis);
  if (!basis || arrays.empty())
  {
    Refuse(
      std::string("it lacks the point array ") + Basis + " or the field arrays " + Prefix + "…");
  }
  result.Model = palpate::model_of(arrays);
  const Eigen::Index coordinates = result.Model.num_coordinates();
  if (basis->GetNumberOfComponents() != 3 * coordinates)
  {
    Refuse(std::string(Basis) + " has " + std::to_string(basis->GetNumberOfComponents()) +
      " components in place of three for each of its " + std::to_string(coordinates) +
      " coordinates");
  }
  result.Basis.resize(3 * basis->GetNumberOfTuples(), coordinates);
  for (vtkIdType point = 0; point < basis->GetNumberOfTuples(); ++point)
  {
    for (Eigen::Index coordinate = 0; coordinate < coordinates; ++coordinate)
    {
      for (int axis = 0; axis < 3; ++axis)
      {
        result.Basis(3 * point + axis, coordinate) =
          basis->GetComponent(point, static_cast<int>(3 * coordinate + axis));
      }
    }
  }
  result.Rest.setZero(result.Basis.rows());
  if (result.Model.points.rest_gradients.size() > 0)
  {
    vtkDataArray* rest = body->GetPointData()->GetArray(Rest);
    if (!rest || rest->GetNumberOfComponents() != 3)
    {
      Refuse(std::string("it lacks the point array ") + Rest + ", of three components");
    }
    for (vtkIdType point = 0; point < rest->GetNumberOfTuples(); ++point)
    {
      rest->GetTuple(point, result.Rest.data() + 3 * point);
    }
  }
  vtkDataArray* nodes = fields->GetArray(ActiveNodes);
  if (!nodes || 3 * nodes->GetNumberOfTuples() != result.Model.num_tool_coordinates)
  {
    Refuse(std::string("it lacks the field array ") + ActiveNodes + ", with a node for each tool");
  }
  for (vtkIdType tool = 0; tool < nodes->GetNumberOfTuples(); ++tool)
  {
    result.ActiveNodes.push_back(static_cast<vtkIdType>(nodes->GetComponent(tool, 0)));
  }
  return result;
}
