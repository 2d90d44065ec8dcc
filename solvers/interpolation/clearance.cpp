// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/clearance.h"

#include <array>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

namespace palpate {
namespace {

/// A map of so many places takes about 100 MB. For further places, the clearance is computed each
/// time.
constexpr std::size_t kMostPlaces = 1'000'000;

class Memory {
 public:
  explicit Memory(Clearance clearance) : clearance_(std::move(clearance)) {}

  double ask(const Vec3& q) {
    const std::array<double, 3> place{q[0], q[1], q[2]};
    {
      const std::lock_guard lock(mutex_);
      const auto known = values_.find(place);
      if (known != values_.end()) return known->second;
    }
    const double value = clearance_(q);
    const std::lock_guard lock(mutex_);
    if (values_.size() < kMostPlaces) values_.emplace(place, value);
    return value;
  }

 private:
  Clearance clearance_;
  std::mutex mutex_;
  std::map<std::array<double, 3>, double> values_;
};

}  // namespace

Clearance remembering(Clearance clearance) {
  return [memory = std::make_shared<Memory>(std::move(clearance))](const Vec3& q) {
    return memory->ask(q);
  };
}

}  // namespace palpate
