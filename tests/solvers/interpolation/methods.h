// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "interpolation/interpolator.h"

namespace palpate::test {

/// All but the linear one, which is none.
inline std::vector<Method> interpolating_methods() {
  std::vector<Method> methods = all_methods();
  methods.pop_back();
  return methods;
}

/// For a test that is parameterised by the method.
inline std::string name_of_method(const testing::TestParamInfo<Method>& method) {
  std::string name = to_string(method.param);
  name.erase(std::remove(name.begin(), name.end(), ' '), name.end());
  return name;
}

}  // namespace palpate::test
