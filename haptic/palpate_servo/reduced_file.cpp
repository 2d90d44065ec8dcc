// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/palpate_servo/reduced_file.h"

#include <cmath>
#include <string>

#include "base/error.h"
#include "reduced/model_arrays.h"
#include "state_space/surface.h"

namespace palpate {
namespace {

/// The names under which reduction/kept_model.h stores the arrays.
constexpr const char* kActiveNodes = "ActiveNodes";
constexpr const char* kRest = "Rest";

std::string join(const std::vector<Index>& numbers) {
  std::string text;
  for (const Index number : numbers) text += (text.empty() ? "" : ", ") + std::to_string(number);
  return text;
}

/// @throws InputError the model is damaged.
storage::Arrays read_arrays(const StateSpaceFile& file, const std::string& key,
                            const std::string& name) {
  auto arrays = file.reduced_models().read(key);
  if (arrays) return *std::move(arrays);
  const std::vector<std::string> left_out = file.left_out();
  throw InputError(name + " cannot be read. " +
                   (left_out.empty() ? "" : describe_left_out(file.path(), left_out) + ' ') +
                   "Build Reduced Model with the same file repairs it.");
}

/// @throws InputError the nodes are not points of a body with `num_points` points.
std::vector<Index> active_nodes(const storage::Arrays& arrays, Index num_points,
                                const std::string& name) {
  const auto found = arrays.find(kActiveNodes);
  if (found == arrays.end() || found->second.cols() != 1) {
    throw InputError(name +
                     " does not say where its tools are. Build it again, into another file.");
  }
  std::vector<Index> nodes;
  for (const double node : found->second.col(0)) {
    if (!(node >= 0 && node < num_points && node == std::floor(node))) {
      throw InputError(name + " has a tool at a point that its body of " +
                       std::to_string(num_points) +
                       " points has not. Build it again, into another file.");
    }
    nodes.push_back(static_cast<Index>(node));
  }
  return nodes;
}

/// Moves the points of the body to where they are at rest under gravity.
/// @throws InputError the displacement is not stored for each point.
void let_sag(const storage::Arrays& arrays, const std::string& name, std::vector<Vec3>& points) {
  const auto found = arrays.find(kRest);
  const auto num_rows = 3 * static_cast<Eigen::Index>(points.size());
  if (found == arrays.end() || found->second.rows() != num_rows || found->second.cols() != 1) {
    throw InputError(name +
                     " does not say where its body is at rest. Build it again, into another file.");
  }
  for (std::size_t p = 0; p < points.size(); ++p) {
    points[p] += found->second.col(0).segment<3>(3 * static_cast<Eigen::Index>(p));
  }
}

/// The models in words, such as "1 (tools at points 8, 23; 30 modes)" for each.
std::string list_models(const StateSpaceFile& file, Index num_points,
                        const std::vector<std::string>& keys) {
  std::string text;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    text += (text.empty() ? "" : ", ") + std::to_string(i + 1);
    try {
      const auto arrays = read_arrays(file, keys[i], "It");
      text += " (tools at points " + join(active_nodes(arrays, num_points, "It")) + "; " +
              std::to_string(model_of(arrays).num_modes) + " modes)";
    } catch (const InputError&) {
      text += " (damaged)";
    }
  }
  return text;
}

}  // namespace

bool has_only_reduced_models(const StateSpaceFile& file) {
  return file.read_tool_spaces().empty() && !file.reduced_models().list().empty();
}

TouchedModel read_touched_model(const StateSpaceFile& file, std::optional<std::int64_t> number) {
  const std::string path = file.path().string();
  const std::vector<std::string> keys = file.reduced_models().list();
  if (keys.empty()) {
    throw InputError(path +
                     " holds no reduced model that is complete. Give a file that Build Reduced "
                     "Model has written, or leave out --reduced.");
  }
  const auto num_models = static_cast<std::int64_t>(keys.size());
  Scene scene = file.read_scene();
  const Index num_points = scene.body.mesh.num_points();
  if (number.value_or(num_models) < 1 || number.value_or(1) > num_models ||
      (!number && num_models > 1)) {
    throw InputError(path + " holds the reduced model(s) " + list_models(file, num_points, keys) +
                     (number ? ", and no " + std::to_string(*number) : "") +
                     ". Give the number of one with --reduced.");
  }
  TouchedModel touched;
  touched.number = number.value_or(1);
  const std::string name = "The reduced model " + std::to_string(touched.number) + " of " + path;
  const auto arrays = read_arrays(file, keys[static_cast<std::size_t>(touched.number - 1)], name);
  touched.model = std::make_shared<const ReducedModel>(model_of(arrays));
  touched.nodes = active_nodes(arrays, num_points, name);
  const Eigen::VectorXd& trained = touched.model->trained_tools;
  if (trained.size() != 3 * static_cast<Eigen::Index>(touched.nodes.size())) {
    throw InputError(name + " has " + std::to_string(trained.size() / 3) + " tool(s), but " +
                     std::to_string(touched.nodes.size()) +
                     " active node(s). Build it again, into another file.");
  }
  if (touched.model->points.rest_gradients.size() > 0)
    let_sag(arrays, name, scene.body.mesh.points);
  const Surface surface = make_surface(scene.body.mesh);
  const std::vector<Vec3> normals = point_normals(surface);
  for (const Index node : touched.nodes) {
    const Index at = surface.find(node);
    if (at < 0) {
      throw InputError(name + " has a tool at point " + std::to_string(node) +
                       ", which is inside of the body. Build it again, with active nodes of the "
                       "surface.");
    }
    const auto tool = 3 * static_cast<Eigen::Index>(touched.tools.size());
    const auto place = static_cast<std::size_t>(at);
    touched.tools.push_back(
        {surface.points[place], normals[place], trained.segment<3>(tool).maxCoeff()});
  }
  return touched;
}

}  // namespace palpate
