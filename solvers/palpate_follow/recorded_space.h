// SPDX-License-Identifier: BSD-3-Clause
// A space of a rigid tool in a file: the body and the tool with which a hand is followed, and what
// the configurations have taken.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "exploration/precompute_options.h"
#include "interaction/interaction_spec.h"
#include "state_space/configuration.h"
#include "state_space/space_body.h"

namespace palpate {

class RecordedSpace {
 public:
  /// @throws InputError the file has no space of a rigid tool that presses the body.
  explicit RecordedSpace(const std::string& path);

  [[nodiscard]] const SpaceBody& body() const { return body_; }
  [[nodiscard]] const ToolSpaceSetup& setup() const { return setup_; }
  [[nodiscard]] const std::shared_ptr<const ToolClearance>& clearance() const { return clearance_; }
  /// Those of the whole surface, around the middle, with the same tool, cells and depth.
  [[nodiscard]] PrecomputeOptions options() const;
  /// Of all that is pressed, the place of the surface that is nearest to its middle, m.
  [[nodiscard]] const Vec3& middle() const { return middle_; }
  [[nodiscard]] const std::map<CheckPoint, ConfigurationSummary>& configurations() const {
    return configurations_;
  }
  /// Of the configurations in which the tool touches the body, what one has taken in the mean, s.
  [[nodiscard]] double mean_seconds() const { return mean_seconds_; }

 private:
  /// @param pressed Places of the surface that are pressed, m; some.
  void find_middle(const std::vector<Vec3>& pressed);

  SpaceBody body_;
  ToolSpaceSetup setup_;
  std::unique_ptr<InteractionFactory> tools_;
  std::shared_ptr<const ToolClearance> clearance_;
  std::map<CheckPoint, ConfigurationSummary> configurations_;
  Vec3 middle_ = Vec3::Zero();
  double mean_seconds_ = 0;
};

}  // namespace palpate
