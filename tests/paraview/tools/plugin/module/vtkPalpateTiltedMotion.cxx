// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateTiltedMotion.h"

#include <cmath>
#include <memory>
#include <vector>

#include "interaction/motion_kind.h"
#include "interaction/pose_map.h"
#include "interaction/rigid_tool.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateTool.h"

vtkStandardNewMacro(vtkPalpateTiltedMotion);

namespace {
constexpr auto Tilted = static_cast<palpate::ToolMotion>(100);

class TiltedPose final : public palpate::PoseMap {
 public:
  explicit TiltedPose(double degrees)
      : Rotation(
            Eigen::AngleAxisd(degrees * M_PI / 180, palpate::Vec3::UnitZ()).toRotationMatrix()) {}
  int num_coordinates() const noexcept override { return 3; }
  palpate::PoseJet evaluate(const Eigen::VectorXd& q, int) const override {
    palpate::PoseJet pose(3);
    pose.place = q;
    pose.rotation = this->Rotation;
    for (int i = 0; i < 3; ++i) {
      pose.place_by[i] = palpate::Vec3::Unit(i);
    }
    return pose;
  }

 private:
  palpate::Mat3 Rotation;
};

class TiltedKind final : public palpate::MotionKind {
 public:
  TiltedKind() = default;
  palpate::ToolMotion number() const override { return Tilted; }
  palpate::PoseMapPtr make(const std::vector<double>& numbers) const override {
    return std::make_shared<const TiltedPose>(numbers.at(0));
  }
};

[[maybe_unused]] const bool TiltIsKnown =
    (vtkPalpateTool::AddKind(std::make_unique<const TiltedKind>()), true);
}  // namespace

void vtkPalpateTiltedMotion::Describe(palpate::RigidTool& tool) const {
  tool.motion = Tilted;
  tool.motion_numbers = {this->Angle};
}
