// SPDX-License-Identifier: BSD-3-Clause
#include "reduced/model_arrays.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace palpate {
namespace {

/// The array with a name, which must have this number of columns.
const Eigen::MatrixXd& find(const NamedArrays& arrays, const std::string& name,
                            Eigen::Index columns = -1) {
  const auto found = arrays.find(name);
  if (found == arrays.end()) {
    throw InputError("The reduced model is damaged: it has no array " + name + ". Build it again.");
  }
  if (columns >= 0 && found->second.cols() != columns) {
    throw InputError("The reduced model is damaged: its array " + name + " has " +
                     std::to_string(found->second.cols()) + " columns in place of " +
                     std::to_string(columns) + ". Build it again.");
  }
  return found->second;
}

/// A number as an integer; −1 if it cannot be one, as in a damaged file.
Index whole(double number) {
  constexpr double kMost = 1 << 30;
  return std::abs(number) <= kMost ? static_cast<Index>(number) : -1;
}

template <class Values>
Eigen::RowVectorXd row_of(const Values& values) {
  return Eigen::Map<const Eigen::RowVectorXd>(values.data(),
                                              static_cast<Eigen::Index>(values.size()));
}

template <class Values>
Values values_in(const Eigen::RowVectorXd& row) {
  Values values{};
  std::copy(row.begin(), row.end(), values.begin());
  return values;
}

}  // namespace

NamedArrays arrays_of(const ReducedModel& model) {
  NamedArrays arrays;
  const auto num_materials = static_cast<Eigen::Index>(model.materials.size());
  Eigen::MatrixXd& materials = arrays["Materials"];
  materials.resize(num_materials, 1 + max_parameters);
  Eigen::MatrixXd& rheologies = arrays["Rheologies"];
  rheologies.resize(num_materials, num_rheology_values);
  for (Eigen::Index m = 0; m < num_materials; ++m) {
    const auto at = static_cast<std::size_t>(m);
    materials(m, 0) = static_cast<double>(model.materials[at].law);
    materials.row(m).tail(max_parameters) = row_of(model.materials[at].parameters);
    rheologies.row(m) = row_of(values_of(model.rheologies[at]));
  }
  const ReducedPoints& points = model.points;
  Eigen::MatrixXd& groups = arrays["PointGroups"];
  groups.resize(static_cast<Eigen::Index>(points.groups.size()), 3);
  for (Eigen::Index g = 0; g < groups.rows(); ++g) {
    const ReducedPoints::Group& group = points.groups[static_cast<std::size_t>(g)];
    groups.row(g) << static_cast<double>(group.law), group.first_packet, group.last_packet;
  }
  const Eigen::Map<const Eigen::Matrix<Index, Eigen::Dynamic, 1>> material(
      points.material.data(), static_cast<Eigen::Index>(points.material.size()));
  arrays["PointMaterials"] = material.cast<double>();
  arrays["PointWeights"] = points.weights;
  arrays["PointGradients"] = points.gradients;
  if (points.rest_gradients.size() > 0) arrays["RestGradients"] = points.rest_gradients;
  arrays["Mass"] = model.mass;
  if (model.support_stiffness.size() > 0) arrays["SupportStiffness"] = model.support_stiffness;
  arrays["ToolStiffness"] = model.tool_stiffness;
  arrays["TrainedModes"] = model.trained_modes;
  arrays["TrainedTools"] = model.trained_tools;
  return arrays;
}

ReducedModel model_of(const NamedArrays& arrays) {
  ReducedModel model;
  const Eigen::MatrixXd& materials = find(arrays, "Materials", 1 + max_parameters);
  const Eigen::MatrixXd& rheologies = find(arrays, "Rheologies", num_rheology_values);
  for (Eigen::Index m = 0; m < materials.rows(); ++m) {
    const Index law = whole(materials(m, 0));
    if (law < 0 || law >= num_laws) {
      throw InputError("The reduced model is damaged: it has a material of law " +
                       std::to_string(law) + ". Build it again.");
    }
    using Parameters = std::array<double, max_parameters>;
    model.materials.push_back(with_formulation(
        make_material(static_cast<Law>(law),
                      values_in<Parameters>(materials.row(m).tail(max_parameters))),
        Formulation::displacement));
  }
  for (Eigen::Index m = 0; m < rheologies.rows(); ++m) {
    model.rheologies.push_back(make_rheology(values_in<RheologyValues>(rheologies.row(m))));
  }
  ReducedPoints& points = model.points;
  const Eigen::MatrixXd& groups = find(arrays, "PointGroups", 3);
  for (Eigen::Index g = 0; g < groups.rows(); ++g) {
    points.groups.push_back(
        {static_cast<Law>(whole(groups(g, 0))), whole(groups(g, 1)), whole(groups(g, 2))});
  }
  for (const double number : find(arrays, "PointMaterials", 1).col(0)) {
    points.material.push_back(whole(number));
  }
  points.weights = find(arrays, "PointWeights", 1);
  points.gradients = find(arrays, "PointGradients");
  if (arrays.count("RestGradients") > 0) points.rest_gradients = find(arrays, "RestGradients", 1);
  model.mass = find(arrays, "Mass");
  if (arrays.count("SupportStiffness") > 0) {
    model.support_stiffness = find(arrays, "SupportStiffness");
  }
  model.tool_stiffness = find(arrays, "ToolStiffness");
  model.trained_modes = find(arrays, "TrainedModes", 1);
  model.trained_tools = find(arrays, "TrainedTools", 1);
  model.num_modes = static_cast<Index>(model.trained_modes.size());
  model.num_tool_coordinates = static_cast<Index>(model.trained_tools.size());
  validate(model);
  return model;
}

}  // namespace palpate
