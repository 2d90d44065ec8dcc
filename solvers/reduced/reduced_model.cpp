// SPDX-License-Identifier: BSD-3-Clause
#include "reduced/reduced_model.h"

#include <string>

#include "base/error.h"
#include "base/simd.h"

namespace palpate {
namespace {

void require(bool good, const std::string& what) {
  if (good) return;
  throw InputError("The reduced model is damaged: " + what + " Build it again.");
}

void check_sizes(const Eigen::MatrixXd& matrix, Eigen::Index rows, Eigen::Index columns,
                 const std::string& name) {
  require(matrix.rows() == rows && matrix.cols() == columns,
          name + " has " + std::to_string(matrix.rows()) + " x " + std::to_string(matrix.cols()) +
              " numbers in place of " + std::to_string(rows) + " x " + std::to_string(columns) +
              '.');
  require(matrix.allFinite(), name + " has a number that is not finite.");
}

void check_points(const ReducedModel& model) {
  const ReducedPoints& points = model.points;
  require(points.material.size() % kPacketSize == 0, "its points fill no whole packets.");
  const Eigen::Index num_packets = points.num_packets();
  check_sizes(points.gradients, 9 * kPacketSize * num_packets, model.num_coordinates(),
              "the array of gradients");
  if (points.rest_gradients.size() > 0) {
    check_sizes(points.rest_gradients, 9 * kPacketSize * num_packets, 1,
                "the array of gradients at rest");
  }
  check_sizes(points.weights, kPacketSize * num_packets, 1, "the array of weights");
  require((points.weights.array() >= 0).all(), "a point has a negative weight.");
  require(points.num_points() > 0, "no point has a weight.");
  Index next = 0;
  for (const ReducedPoints::Group& group : points.groups) {
    require(group.first_packet == next && group.last_packet > next,
            "its groups of points do not follow each other.");
    next = group.last_packet;
    for (Index at = kPacketSize * group.first_packet; at < kPacketSize * next; ++at) {
      require(at < static_cast<Index>(points.material.size()), "a group has no points.");
      const Index number = points.material[at];
      require(number >= 0 && number < static_cast<Index>(model.materials.size()),
              "a point has a material that is not there.");
      require(law_of_energy(model.materials[number].law) == group.law,
              "a point is in the group of another law.");
    }
  }
  require(next == num_packets, "some of its points are in no group.");
}

}  // namespace

void validate(const ReducedModel& model) {
  require(model.num_modes >= 0, "its number of modes is negative.");
  require(model.num_tool_coordinates > 0 && model.num_tool_coordinates % 3 == 0,
          "it has no tools of three coordinates each.");
  require(!model.materials.empty() && model.materials.size() == model.rheologies.size(),
          "its materials and rheologies differ in number.");
  for (const Material& material : model.materials) {
    require(material.formulation == Formulation::displacement, "one of its materials is mixed.");
  }
  for (const Rheology& rheology : model.rheologies) validate(rheology);
  const Eigen::Index n = model.num_coordinates();
  check_sizes(model.mass, n, n, "the mass");
  if (model.support_stiffness.size() > 0) {
    check_sizes(model.support_stiffness, n, n, "the stiffness of the supports");
  }
  check_sizes(model.tool_stiffness, model.num_tool_coordinates, model.num_tool_coordinates,
              "the stiffness of the tools");
  check_sizes(model.trained_modes, model.num_modes, 1, "the range of the modes");
  check_sizes(model.trained_tools, model.num_tool_coordinates, 1, "the range of the tools");
  require((model.trained_modes.array() > 0).all() && (model.trained_tools.array() > 0).all(),
          "the range of a coordinate is not positive.");
  check_points(model);
}

void add_memory(const ReducedModel& model, MemoryRanges& ranges) {
  ranges.push_back({&model, sizeof model});
  add_memory(model.materials, ranges);
  add_memory(model.rheologies, ranges);
  add_memory(model.points.groups, ranges);
  add_memory(model.points.material, ranges);
  add_memory(model.points.weights, ranges);
  add_memory(model.points.gradients, ranges);
  add_memory(model.points.rest_gradients, ranges);
  add_memory(model.mass, ranges);
  add_memory(model.support_stiffness, ranges);
  add_memory(model.tool_stiffness, ranges);
  add_memory(model.trained_modes, ranges);
  add_memory(model.trained_tools, ranges);
}

}  // namespace palpate
